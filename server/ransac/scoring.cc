#include "server/ransac/scoring.h"

#include <cmath>

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

// Sums of scores and of inliers over lanes.
struct Sums {
  Floats score;
  Floats inliers;

  HWY_INLINE explicit Sums(Lanes d) : score(hn::Zero(d)), inliers(hn::Zero(d)) {}
  template <typename Mask>
  HWY_INLINE void Add(Lanes d, Mask inlier, Floats value) {
    score = hn::Add(score, hn::IfThenElseZero(inlier, value));
    inliers = hn::Add(inliers, hn::IfThenElseZero(inlier, hn::Set(d, 1.0f)));
  }
  HWY_INLINE Support Total(Lanes d) const {
    Support support;
    support.score = hn::GetLane(hn::SumOfLanes(d, score));
    support.inliers = static_cast<int>(hn::GetLane(hn::SumOfLanes(d, inliers)));
    return support;
  }
};

Support PointKernel(const PointArrays& points, std::size_t begin, std::size_t end,
                    const ScoringPose& pose, const ScoringOptions& options) {
  const Lanes d;
  const Transform camera_from_map(d, pose);
  const Floats inverse_threshold2 = hn::Set(d, 1.0f / (options.threshold * options.threshold));
  const Floats one = hn::Set(d, 1.0f);
  const Floats zero = hn::Zero(d);
  Sums sums(d);
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const Vec3 q =
        camera_from_map.Point(Load3(d, points.x.data(), points.y.data(), points.z.data(), i));
    const Floats inverse_depth = Reciprocal(d, q.z);
    const Floats ex = hn::MulSub(q.x, inverse_depth, hn::LoadU(d, points.u.data() + i));
    const Floats ey = hn::MulSub(q.y, inverse_depth, hn::LoadU(d, points.v.data() + i));
    const Floats error2 = hn::MulAdd(ex, ex, hn::Mul(ey, ey));
    const Floats value = hn::NegMulAdd(error2, inverse_threshold2, one);
    sums.Add(d, hn::And(hn::Gt(value, zero), hn::Gt(q.z, zero)), value);
  }
  return sums.Total(d);
}

Support LineKernel(const LineArrays& lines, const ScoringPose& pose,
                   const ScoringOptions& options) {
  const Lanes d;
  const Transform camera_from_map(d, pose);
  const Floats threshold2 = hn::Set(d, options.threshold * options.threshold);
  const Floats half_inverse = hn::Set(d, 0.5f / (options.threshold * options.threshold));
  const Floats min_length2 = hn::Set(d, options.min_line_length * options.min_line_length);
  const Floats one = hn::Set(d, 1.0f);
  const Floats zero = hn::Zero(d);
  Sums sums(d);
  for (std::size_t i = 0; i < lines.x.size(); i += hn::Lanes(d)) {
    const Vec3 a =
        camera_from_map.Point(Load3(d, lines.x.data(), lines.y.data(), lines.z.data(), i));
    const Vec3 along =
        camera_from_map.Direction(Load3(d, lines.dx.data(), lines.dy.data(), lines.dz.data(), i));
    // Moment a x along: the plane through the camera's centre and the map line.
    const Floats mx = hn::MulSub(a.y, along.z, hn::Mul(a.z, along.y));
    const Floats my = hn::MulSub(a.z, along.x, hn::Mul(a.x, along.z));
    const Floats mz = hn::MulSub(a.x, along.y, hn::Mul(a.y, along.x));
    const Floats norm2 = hn::MulAdd(mx, mx, hn::Mul(my, my));
    const Floats d0 = hn::MulAdd(mx, hn::LoadU(d, lines.u0.data() + i),
                                 hn::MulAdd(my, hn::LoadU(d, lines.v0.data() + i), mz));
    const Floats d1 = hn::MulAdd(mx, hn::LoadU(d, lines.u1.data() + i),
                                 hn::MulAdd(my, hn::LoadU(d, lines.v1.data() + i), mz));
    const Floats e0 = hn::Mul(d0, d0);
    const Floats e1 = hn::Mul(d1, d1);
    // Projected length^2 is (mz^2 + (a.y b.z - ...)) / (a.z b.z)^2; with b = a + along the two
    // differences of cross-multiplied coordinates are moments too: (my, -mx).
    const Floats bz = hn::Add(a.z, along.z);
    const Floats depths = hn::Mul(a.z, bz);
    const auto crosses = hn::Le(hn::Min(a.z, bz), zero);
    const auto long_enough =
        hn::Or(crosses, hn::Ge(norm2, hn::Mul(min_length2, hn::Mul(depths, depths))));
    const auto in_front = hn::Gt(hn::Max(a.z, bz), zero);
    const auto close = hn::Lt(hn::Max(e0, e1), hn::Mul(threshold2, norm2));
    const Floats value =
        hn::NegMulAdd(hn::Mul(hn::Add(e0, e1), Reciprocal(d, norm2)), half_inverse, one);
    sums.Add(d, hn::And(hn::And(close, hn::Gt(value, zero)), hn::And(in_front, long_enough)),
             value);
  }
  return sums.Total(d);
}

}  // namespace HWY_NAMESPACE
}  // namespace maploc
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace maploc {

HWY_EXPORT(PointKernel);
HWY_EXPORT(LineKernel);

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

Support ScoreLines(const LineArrays& lines, const ScoringPose& pose,
                   const ScoringOptions& options) {
  return HWY_DYNAMIC_DISPATCH(LineKernel)(lines, pose, options);
}

}  // namespace maploc
#endif  // HWY_ONCE
