// The scoring kernels' values for features with frames (pixel_frame.h): rays instead of a plane, so
// that a camera sees as wide as it likes. Twice the plane's arithmetic, and 12 floats a point.
#if defined(MAPLOC_FRAME_SCORING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MAPLOC_FRAME_SCORING_INL_H_
#undef MAPLOC_FRAME_SCORING_INL_H_
#else
#define MAPLOC_FRAME_SCORING_INL_H_
#endif

#include "hwy/highway.h"
#include "server/ransac/scoring.h"
#include "server/ransac/scoring_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace maploc {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

class FramePointValues {
 public:
  HWY_INLINE FramePointValues(Lanes d, const PointArrays& points, const ScoringPose& pose,
                              const ScoringOptions& options)
      : points_(points),
        camera_from_map_(d, pose),
        inverse_threshold2_(hn::Set(d, 1.0f / (options.threshold * options.threshold))) {}

  HWY_INLINE Values At(Lanes d, std::size_t i) const {
    const Vec3 q =
        camera_from_map_.Point(Load3(d, points_.x.data(), points_.y.data(), points_.z.data(), i));
    const auto& frame = points_.frame;
    const Floats depth = Dot(LoadColumns(d, &frame[0], i), q);
    const Floats inverse_depth = Reciprocal(d, depth);
    const Floats ex = hn::Mul(Dot(LoadColumns(d, &frame[3], i), q), inverse_depth);
    const Floats ey = hn::Mul(Dot(LoadColumns(d, &frame[6], i), q), inverse_depth);
    const Floats error2 = hn::MulAdd(ex, ex, hn::Mul(ey, ey));
    const Floats value = hn::NegMulAdd(error2, inverse_threshold2_, hn::Set(d, 1.0f));
    const Floats zero = hn::Zero(d);
    return {value, hn::And(hn::Gt(value, zero), hn::Gt(depth, zero))};
  }

  HWY_INLINE hn::Mask<Lanes> Scores(Lanes d, std::size_t i) const { return At(d, i).scores; }

 private:
  const PointArrays& points_;
  const Transform camera_from_map_;
  const Floats inverse_threshold2_;
};

class FrameLineValues {
 public:
  HWY_INLINE FrameLineValues(Lanes d, const LineArrays& lines, const ScoringPose& pose,
                             const ScoringOptions& options)
      : lines_(lines),
        camera_from_map_(d, pose),
        inverse_threshold2_(hn::Set(d, 1.0f / (options.threshold * options.threshold))),
        min_length2_(hn::Set(d, options.min_line_length * options.min_line_length)) {}

  HWY_INLINE Values At(Lanes d, std::size_t i) const {
    const Vec3 a =
        camera_from_map_.Point(Load3(d, lines_.x.data(), lines_.y.data(), lines_.z.data(), i));
    const Vec3 along = camera_from_map_.Direction(
        Load3(d, lines_.dx.data(), lines_.dy.data(), lines_.dz.data(), i));
    const Vec3 moment = Cross(a, along);
    const Floats e0 = EndError2(d, &lines_.frames[0], moment, i);
    const Floats e1 = EndError2(d, &lines_.frames[9], moment, i);
    const Floats zero = hn::Zero(d);
    const Floats one = hn::Set(d, 1.0f);
    const auto close = hn::Lt(hn::Max(e0, e1), one);
    const Floats value = hn::NegMulAdd(hn::Add(e0, e1), hn::Set(d, 0.5f), one);
    return {value, hn::And(hn::And(close, hn::Gt(value, zero)),
                           hn::And(IsInFront(d, a, along, i), IsLong(d, a, along, moment, i)))};
  }

 private:
  // In squared thresholds, of the end whose ray and gradient stand in nine arrays from `frame` on.
  HWY_INLINE Floats EndError2(Lanes d, const std::vector<float>* frame, const Vec3& moment,
                              std::size_t i) const {
    const Floats off = Dot(LoadColumns(d, frame, i), moment);
    const Floats gx = Dot(LoadColumns(d, frame + 3, i), moment);
    const Floats gy = Dot(LoadColumns(d, frame + 6, i), moment);
    const Floats norm2 = hn::MulAdd(gx, gx, hn::Mul(gy, gy));
    return hn::Mul(hn::Mul(off, off), hn::Mul(Reciprocal(d, norm2), inverse_threshold2_));
  }

  // Some of the segment lies on the side of the seen rays.
  HWY_INLINE hn::Mask<Lanes> IsInFront(Lanes d, const Vec3& a, const Vec3& along,
                                       std::size_t i) const {
    const Vec3 first = LoadColumns(d, &lines_.frames[0], i);
    const Vec3 last = LoadColumns(d, &lines_.frames[9], i);
    const Vec3 axis = {hn::Add(first.x, last.x), hn::Add(first.y, last.y),
                       hn::Add(first.z, last.z)};
    const Floats depth = Dot(axis, a);
    return hn::Gt(hn::Max(depth, hn::Add(depth, Dot(axis, along))), hn::Zero(d));
  }

  // Seen under 90 degrees or more, or long enough by sine of angle times scale.
  HWY_INLINE hn::Mask<Lanes> IsLong(Lanes d, const Vec3& a, const Vec3& along, const Vec3& moment,
                                    std::size_t i) const {
    const Vec3 b = {hn::Add(a.x, along.x), hn::Add(a.y, along.y), hn::Add(a.z, along.z)};
    const Floats scale = hn::LoadU(d, lines_.scale.data() + i);
    const Floats length2 = hn::Mul(Dot(moment, moment), hn::Mul(scale, scale));
    const Floats ranges2 = hn::Mul(Dot(a, a), Dot(b, b));
    return hn::Or(hn::Le(Dot(a, b), hn::Zero(d)), hn::Ge(length2, hn::Mul(min_length2_, ranges2)));
  }

  const LineArrays& lines_;
  const Transform camera_from_map_;
  const Floats inverse_threshold2_;
  const Floats min_length2_;
};

}  // namespace HWY_NAMESPACE
}  // namespace maploc
HWY_AFTER_NAMESPACE();
#endif  // per target
