#include "server/ransac/scoring.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/ransac/scoring.cc"  // NOLINT
#include "hwy/foreach_target.h"                        // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace maploc {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, 16>;
using Floats = hn::Vec<Lanes>;

struct Vec3 {
  Floats x, y, z;
};

// One step of Newton on the hardware's estimate: 23 bits, and no division.
HWY_INLINE Floats Reciprocal(Lanes d, Floats v) {
  const Floats estimate = hn::ApproximateReciprocal(v);
  return hn::Mul(estimate, hn::NegMulAdd(v, estimate, hn::Set(d, 2.0f)));
}

struct Transform {
  Floats r[9];
  Floats t[3];

  HWY_INLINE Transform(Lanes d, const ScoringPose& pose) {
    for (int i = 0; i < 9; ++i) r[i] = hn::Set(d, pose.rotation[i]);
    for (int i = 0; i < 3; ++i) t[i] = hn::Set(d, pose.translation[i]);
  }
  HWY_INLINE Vec3 Point(const Vec3& p) const {
    return {hn::MulAdd(r[0], p.x, hn::MulAdd(r[1], p.y, hn::MulAdd(r[2], p.z, t[0]))),
            hn::MulAdd(r[3], p.x, hn::MulAdd(r[4], p.y, hn::MulAdd(r[5], p.z, t[1]))),
            hn::MulAdd(r[6], p.x, hn::MulAdd(r[7], p.y, hn::MulAdd(r[8], p.z, t[2])))};
  }
  HWY_INLINE Vec3 Direction(const Vec3& p) const {
    return {hn::MulAdd(r[0], p.x, hn::MulAdd(r[1], p.y, hn::Mul(r[2], p.z))),
            hn::MulAdd(r[3], p.x, hn::MulAdd(r[4], p.y, hn::Mul(r[5], p.z))),
            hn::MulAdd(r[6], p.x, hn::MulAdd(r[7], p.y, hn::Mul(r[8], p.z)))};
  }
};

HWY_INLINE Vec3 Load3(Lanes d, const float* x, const float* y, const float* z, std::size_t i) {
  return {hn::LoadU(d, x + i), hn::LoadU(d, y + i), hn::LoadU(d, z + i)};
}

// The value of each lane's feature, and whether it scores.
struct Values {
  Floats value;
  hn::Mask<Lanes> scores;
};

// Sums of scores and of inliers over lanes.
struct Sums {
  Floats score;
  Floats inliers;

  HWY_INLINE explicit Sums(Lanes d) : score(hn::Zero(d)), inliers(hn::Zero(d)) {}
  HWY_INLINE void Add(Lanes d, const Values& values) {
    score = hn::Add(score, hn::IfThenElseZero(values.scores, values.value));
    inliers = hn::Add(inliers, hn::IfThenElseZero(values.scores, hn::Set(d, 1.0f)));
  }
  HWY_INLINE Support Total(Lanes d) const {
    Support support;
    support.score = hn::GetLane(hn::SumOfLanes(d, score));
    support.inliers = static_cast<int>(hn::GetLane(hn::SumOfLanes(d, inliers)));
    return support;
  }
};

class PointValues {
 public:
  HWY_INLINE PointValues(Lanes d, const PointArrays& points, const ScoringPose& pose,
                         const ScoringOptions& options)
      : points_(points),
        camera_from_map_(d, pose),
        inverse_threshold2_(hn::Set(d, 1.0f / (options.threshold * options.threshold))) {}

  HWY_INLINE Values At(Lanes d, std::size_t i) const {
    const Vec3 q =
        camera_from_map_.Point(Load3(d, points_.x.data(), points_.y.data(), points_.z.data(), i));
    const Floats inverse_depth = Reciprocal(d, q.z);
    const Floats ex = hn::MulSub(q.x, inverse_depth, hn::LoadU(d, points_.u.data() + i));
    const Floats ey = hn::MulSub(q.y, inverse_depth, hn::LoadU(d, points_.v.data() + i));
    const Floats error2 = hn::MulAdd(ex, ex, hn::Mul(ey, ey));
    const Floats value = hn::NegMulAdd(error2, inverse_threshold2_, hn::Set(d, 1.0f));
    const Floats zero = hn::Zero(d);
    return {value, hn::And(hn::Gt(value, zero), hn::Gt(q.z, zero))};
  }

 private:
  const PointArrays& points_;
  const Transform camera_from_map_;
  const Floats inverse_threshold2_;
};

class LineValues {
 public:
  HWY_INLINE LineValues(Lanes d, const LineArrays& lines, const ScoringPose& pose,
                        const ScoringOptions& options)
      : lines_(lines),
        camera_from_map_(d, pose),
        threshold2_(hn::Set(d, options.threshold * options.threshold)),
        half_inverse_(hn::Set(d, 0.5f / (options.threshold * options.threshold))),
        min_length2_(hn::Set(d, options.min_line_length * options.min_line_length)) {}

  HWY_INLINE Values At(Lanes d, std::size_t i) const {
    const Vec3 a =
        camera_from_map_.Point(Load3(d, lines_.x.data(), lines_.y.data(), lines_.z.data(), i));
    const Vec3 along = camera_from_map_.Direction(
        Load3(d, lines_.dx.data(), lines_.dy.data(), lines_.dz.data(), i));
    // Moment a x along: the plane through the camera's centre and the map line.
    const Floats mx = hn::MulSub(a.y, along.z, hn::Mul(a.z, along.y));
    const Floats my = hn::MulSub(a.z, along.x, hn::Mul(a.x, along.z));
    const Floats mz = hn::MulSub(a.x, along.y, hn::Mul(a.y, along.x));
    const Floats norm2 = hn::MulAdd(mx, mx, hn::Mul(my, my));
    const Floats d0 = hn::MulAdd(mx, hn::LoadU(d, lines_.u0.data() + i),
                                 hn::MulAdd(my, hn::LoadU(d, lines_.v0.data() + i), mz));
    const Floats d1 = hn::MulAdd(mx, hn::LoadU(d, lines_.u1.data() + i),
                                 hn::MulAdd(my, hn::LoadU(d, lines_.v1.data() + i), mz));
    const Floats e0 = hn::Mul(d0, d0);
    const Floats e1 = hn::Mul(d1, d1);
    // Projected length^2 is (mz^2 + (a.y b.z - ...)) / (a.z b.z)^2; with b = a + along the two
    // differences of cross-multiplied coordinates are moments too: (my, -mx).
    const Floats bz = hn::Add(a.z, along.z);
    const Floats depths = hn::Mul(a.z, bz);
    const Floats zero = hn::Zero(d);
    const auto crosses = hn::Le(hn::Min(a.z, bz), zero);
    const auto long_enough =
        hn::Or(crosses, hn::Ge(norm2, hn::Mul(min_length2_, hn::Mul(depths, depths))));
    const auto in_front = hn::Gt(hn::Max(a.z, bz), zero);
    const auto close = hn::Lt(hn::Max(e0, e1), hn::Mul(threshold2_, norm2));
    const Floats value = hn::NegMulAdd(hn::Mul(hn::Add(e0, e1), Reciprocal(d, norm2)),
                                       half_inverse_, hn::Set(d, 1.0f));
    return {value, hn::And(hn::And(close, hn::Gt(value, zero)), hn::And(in_front, long_enough))};
  }

 private:
  const LineArrays& lines_;
  const Transform camera_from_map_;
  const Floats threshold2_;
  const Floats half_inverse_;
  const Floats min_length2_;
};

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
    if (hn::AllFalse(du, scores)) continue;
    count +=
        hn::CompressStore(hn::Iota(du, static_cast<std::uint32_t>(i)), scores, du, places + count);
  }
  return count;
}

Support PointKernel(const PointArrays& points, std::size_t begin, std::size_t end,
                    const ScoringPose& pose, const ScoringOptions& options) {
  const Lanes d;
  return Score(d, begin, end, PointValues(d, points, pose, options));
}

Support LineKernel(const LineArrays& lines, std::size_t begin, std::size_t end,
                   const ScoringPose& pose, const ScoringOptions& options) {
  const Lanes d;
  return Score(d, begin, end, LineValues(d, lines, pose, options));
}

std::size_t FindPointsKernel(const PointArrays& points, const ScoringPose& pose,
                             const ScoringOptions& options, std::uint32_t* places) {
  const Lanes d;
  return FindScoring(d, points.x.size(), PointValues(d, points, pose, options), places);
}

std::size_t FindLinesKernel(const LineArrays& lines, const ScoringPose& pose,
                            const ScoringOptions& options, std::uint32_t* places) {
  const Lanes d;
  return FindScoring(d, lines.x.size(), LineValues(d, lines, pose, options), places);
}

}  // namespace HWY_NAMESPACE
}  // namespace maploc
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace maploc {

HWY_EXPORT(PointKernel);
HWY_EXPORT(LineKernel);
HWY_EXPORT(FindPointsKernel);
HWY_EXPORT(FindLinesKernel);

namespace {
// Seen so far away that no pose explains it, and finite in its square.
constexpr float kNowhere = 1e15f;
}  // namespace

void PointArrays::Add(float px, float py, float pz, float pu, float pv) {
  x.push_back(px);
  y.push_back(py);
  z.push_back(pz);
  u.push_back(pu);
  v.push_back(pv);
  ++count;
}

void PointArrays::Pad() {
  const std::size_t real = count;
  while (x.size() % kScoringPad != 0) Add(0, 0, 0, kNowhere, kNowhere);
  count = real;
}

void LineArrays::Add(const float start[3], const float direction[3], const float seen[4]) {
  x.push_back(start[0]);
  y.push_back(start[1]);
  z.push_back(start[2]);
  dx.push_back(direction[0]);
  dy.push_back(direction[1]);
  dz.push_back(direction[2]);
  u0.push_back(seen[0]);
  v0.push_back(seen[1]);
  u1.push_back(seen[2]);
  v1.push_back(seen[3]);
  ++count;
}

void LineArrays::Pad() {
  const std::size_t real = count;
  // No direction: no moment, no length, no score.
  const float nothing[4] = {0, 0, 0, 0};
  while (x.size() % kScoringPad != 0) Add(nothing, nothing, nothing);
  count = real;
}

Support ScorePoints(const PointArrays& points, std::size_t begin, std::size_t end,
                    const ScoringPose& pose, const ScoringOptions& options) {
  return HWY_DYNAMIC_DISPATCH(PointKernel)(points, begin, end, pose, options);
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
