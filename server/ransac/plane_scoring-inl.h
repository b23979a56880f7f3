// The scoring kernels' values for a camera with a plane z = 1: five floats a point.
#if defined(MAPLOC_PLANE_SCORING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MAPLOC_PLANE_SCORING_INL_H_
#undef MAPLOC_PLANE_SCORING_INL_H_
#else
#define MAPLOC_PLANE_SCORING_INL_H_
#endif

#include "hwy/highway.h"
#include "server/ransac/scoring.h"
#include "server/ransac/scoring_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace maploc {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

class PlanePointValues {
 public:
  HWY_INLINE PlanePointValues(Lanes d, const PointArrays& points, const ScoringPose& pose,
                              const ScoringOptions& options)
      : points_(points),
        camera_from_map_(d, pose),
        threshold2_(hn::Set(d, options.threshold * options.threshold)),
        inverse_threshold2_(hn::Set(d, 1.0f / (options.threshold * options.threshold))) {}

  // At(d, i).scores without a division.
  HWY_INLINE hn::Mask<Lanes> Scores(Lanes d, std::size_t i) const {
    const Vec3 q =
        camera_from_map_.Point(Load3(d, points_.x.data(), points_.y.data(), points_.z.data(), i));
    const Floats ex = hn::NegMulAdd(hn::LoadU(d, points_.u.data() + i), q.z, q.x);
    const Floats ey = hn::NegMulAdd(hn::LoadU(d, points_.v.data() + i), q.z, q.y);
    const Floats error2 = hn::MulAdd(ex, ex, hn::Mul(ey, ey));
    // Zero behind the camera: no error is below.
    const Floats most2 = hn::Mul(hn::Mul(threshold2_, q.z), hn::Max(q.z, hn::Zero(d)));
    return hn::Lt(error2, most2);
  }

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
  const Floats threshold2_;
  const Floats inverse_threshold2_;
};

class PlaneLineValues {
 public:
  HWY_INLINE PlaneLineValues(Lanes d, const LineArrays& lines, const ScoringPose& pose,
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

}  // namespace HWY_NAMESPACE
}  // namespace maploc
HWY_AFTER_NAMESPACE();
#endif  // per target
