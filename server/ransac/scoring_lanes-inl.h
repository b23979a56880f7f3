// Vectors of three, a pose and the sums over lanes: what the scoring kernels of every camera share.
// Included once a target (Google Highway), hence the toggled guard.
#if defined(MAPLOC_SCORING_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MAPLOC_SCORING_LANES_INL_H_
#undef MAPLOC_SCORING_LANES_INL_H_
#else
#define MAPLOC_SCORING_LANES_INL_H_
#endif

#include "hwy/highway.h"
#include "server/ransac/scoring.h"

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

HWY_INLINE Floats Dot(const Vec3& a, const Vec3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Vec3 Cross(const Vec3& a, const Vec3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

HWY_INLINE Vec3 Load3(Lanes d, const float* x, const float* y, const float* z, std::size_t i) {
  return {hn::LoadU(d, x + i), hn::LoadU(d, y + i), hn::LoadU(d, z + i)};
}

// Of three arrays that stand one after another.
HWY_INLINE Vec3 LoadColumns(Lanes d, const std::vector<float>* columns, std::size_t i) {
  return Load3(d, columns[0].data(), columns[1].data(), columns[2].data(), i);
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

}  // namespace HWY_NAMESPACE
}  // namespace maploc
HWY_AFTER_NAMESPACE();
#endif  // per target
