#include "server/ransac/scoring.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/ransac/scoring.cc"  // NOLINT
#include "hwy/foreach_target.h"                        // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/ransac/frame_scoring-inl.h"
#include "server/ransac/plane_scoring-inl.h"
#include "server/ransac/scoring_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace maploc {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <typename FeatureValues>
HWY_INLINE Support Score(Lanes d, std::size_t begin, std::size_t end,
                         const FeatureValues& features) {
  Sums sums(d);
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) sums.Add(d, features.At(d, i));
  return sums.Total(d);
}

// Writes whole vectors: `places` has room for the padded size and a vector more.
template <typename FeatureValues>
HWY_INLINE std::size_t FindScoring(Lanes d, std::size_t size, const FeatureValues& features,
                                   std::uint32_t* places) {
  const hn::RebindToUnsigned<Lanes> du;
  std::size_t count = 0;
  for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
    const auto scores = hn::RebindMask(du, features.At(d, i).scores);
    // With many outliers most vectors hold no feature that scores, and skip the costly store.
    if (hn::AllFalse(du, scores)) continue;
    count +=
        hn::CompressStore(hn::Iota(du, static_cast<std::uint32_t>(i)), scores, du, places + count);
  }
  return count;
}

Support PointKernel(const PointArrays& points, std::size_t begin, std::size_t end,
                    const ScoringPose& pose, const ScoringOptions& options) {
  const Lanes d;
  if (points.has_frames()) return Score(d, begin, end, FramePointValues(d, points, pose, options));
  return Score(d, begin, end, PlanePointValues(d, points, pose, options));
}

template <typename FeatureValues>
HWY_INLINE int Count(Lanes d, std::size_t begin, std::size_t end, const FeatureValues& features) {
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    count += hn::CountTrue(d, features.Scores(d, i));
  }
  return static_cast<int>(count);
}

int CountPointsKernel(const PointArrays& points, std::size_t begin, std::size_t end,
                      const ScoringPose& pose, const ScoringOptions& options) {
  const Lanes d;
  if (points.has_frames()) return Count(d, begin, end, FramePointValues(d, points, pose, options));
  return Count(d, begin, end, PlanePointValues(d, points, pose, options));
}

Support LineKernel(const LineArrays& lines, std::size_t begin, std::size_t end,
                   const ScoringPose& pose, const ScoringOptions& options) {
  const Lanes d;
  if (lines.has_frames()) return Score(d, begin, end, FrameLineValues(d, lines, pose, options));
  return Score(d, begin, end, PlaneLineValues(d, lines, pose, options));
}

std::size_t FindPointsKernel(const PointArrays& points, const ScoringPose& pose,
                             const ScoringOptions& options, std::uint32_t* places) {
  const Lanes d;
  const std::size_t size = points.x.size();
  if (points.has_frames()) {
    return FindScoring(d, size, FramePointValues(d, points, pose, options), places);
  }
  return FindScoring(d, size, PlanePointValues(d, points, pose, options), places);
}

std::size_t FindLinesKernel(const LineArrays& lines, const ScoringPose& pose,
                            const ScoringOptions& options, std::uint32_t* places) {
  const Lanes d;
  const std::size_t size = lines.x.size();
  if (lines.has_frames()) {
    return FindScoring(d, size, FrameLineValues(d, lines, pose, options), places);
  }
  return FindScoring(d, size, PlaneLineValues(d, lines, pose, options), places);
}

}  // namespace HWY_NAMESPACE
}  // namespace maploc
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace maploc {

HWY_EXPORT(PointKernel);
HWY_EXPORT(CountPointsKernel);
HWY_EXPORT(LineKernel);
HWY_EXPORT(FindPointsKernel);
HWY_EXPORT(FindLinesKernel);

namespace {
// Seen so far away that no pose explains it, and finite in its square.
constexpr float kNowhere = 1e15f;
}  // namespace

void PointArrays::Add(const float position[3], float seen_u, float seen_v) {
  AddPosition(position);
  u.push_back(seen_u);
  v.push_back(seen_v);
}

void PointArrays::Add(const float position[3], const float of_frame[9]) {
  AddPosition(position);
  for (int i = 0; i < 9; ++i) frame[i].push_back(of_frame[i]);
}

void PointArrays::AddPosition(const float position[3]) {
  x.push_back(position[0]);
  y.push_back(position[1]);
  z.push_back(position[2]);
  ++count;
}

void PointArrays::Pad() {
  const std::size_t real = count;
  const bool frames = has_frames();
  // A ray of no length has nothing in front of it.
  constexpr float kNothing[9] = {};
  while (x.size() % kScoringPad != 0) {
    if (frames) {
      Add(kNothing, kNothing);
    } else {
      Add(kNothing, kNowhere, kNowhere);
    }
  }
  count = real;
}

void LineArrays::Add(const float start[3], const float direction[3], const float seen[4]) {
  AddSegment(start, direction);
  u0.push_back(seen[0]);
  v0.push_back(seen[1]);
  u1.push_back(seen[2]);
  v1.push_back(seen[3]);
}

void LineArrays::Add(const float start[3], const float direction[3], const float of_ends[18],
                     float of_length) {
  AddSegment(start, direction);
  for (int i = 0; i < 18; ++i) frames[i].push_back(of_ends[i]);
  scale.push_back(of_length);
}

void LineArrays::AddSegment(const float start[3], const float direction[3]) {
  x.push_back(start[0]);
  y.push_back(start[1]);
  z.push_back(start[2]);
  dx.push_back(direction[0]);
  dy.push_back(direction[1]);
  dz.push_back(direction[2]);
  ++count;
}

void LineArrays::Pad() {
  const std::size_t real = count;
  const bool framed = has_frames();
  // No direction: no moment, no length, no score.
  constexpr float kNothing[18] = {};
  while (x.size() % kScoringPad != 0) {
    if (framed) {
      Add(kNothing, kNothing, kNothing, 0.0f);
    } else {
      Add(kNothing, kNothing, kNothing);
    }
  }
  count = real;
}

Support ScorePoints(const PointArrays& points, std::size_t begin, std::size_t end,
                    const ScoringPose& pose, const ScoringOptions& options) {
  return HWY_DYNAMIC_DISPATCH(PointKernel)(points, begin, end, pose, options);
}

int CountScoringPoints(const PointArrays& points, std::size_t begin, std::size_t end,
                       const ScoringPose& pose, const ScoringOptions& options) {
  return HWY_DYNAMIC_DISPATCH(CountPointsKernel)(points, begin, end, pose, options);
}

Support ScoreLines(const LineArrays& lines, std::size_t begin, std::size_t end,
                   const ScoringPose& pose, const ScoringOptions& options) {
  return HWY_DYNAMIC_DISPATCH(LineKernel)(lines, begin, end, pose, options);
}

std::size_t FindScoringPoints(const PointArrays& points, const ScoringPose& pose,
                              const ScoringOptions& options, std::vector<std::uint32_t>* places) {
  places->resize(points.x.size() + kScoringPad);
  return HWY_DYNAMIC_DISPATCH(FindPointsKernel)(points, pose, options, places->data());
}

std::size_t FindScoringLines(const LineArrays& lines, const ScoringPose& pose,
                             const ScoringOptions& options, std::vector<std::uint32_t>* places) {
  places->resize(lines.x.size() + kScoringPad);
  return HWY_DYNAMIC_DISPATCH(FindLinesKernel)(lines, pose, options, places->data());
}

}  // namespace maploc
#endif  // HWY_ONCE
