#include "server/solvers/batch.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/solvers/batch.cc"  // NOLINT
#include "hwy/foreach_target.h"                       // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace maploc {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// kDoubleRootTolerance, repeated: yaw_equation.h includes Eigen, which must not be compiled once a
// target.
constexpr double kTolerance = 1e-10;

template <class D>
struct Vec3 {
  hn::Vec<D> x, y, z;

  HWY_INLINE Vec3(hn::Vec<D> vx, hn::Vec<D> vy, hn::Vec<D> vz) : x(vx), y(vy), z(vz) {}
  HWY_INLINE Vec3(D d, const VectorArrays& from, std::size_t i)
      : x(hn::LoadU(d, from.x + i)), y(hn::LoadU(d, from.y + i)), z(hn::LoadU(d, from.z + i)) {}
  HWY_INLINE Vec3 operator-(const Vec3& o) const {
    return {hn::Sub(x, o.x), hn::Sub(y, o.y), hn::Sub(z, o.z)};
  }
};

// a b - c d, and a b + c d.
template <class V>
HWY_INLINE V Minus(V a, V b, V c, V d) {
  return hn::NegMulAdd(c, d, hn::Mul(a, b));
}
template <class V>
HWY_INLINE V Plus(V a, V b, V c, V d) {
  return hn::MulAdd(c, d, hn::Mul(a, b));
}

// n . Rz(yaw) D = a cos + b sin + c.
template <class D>
struct Equation {
  hn::Vec<D> a, b, c;

  HWY_INLINE Equation(const Vec3<D>& n, const Vec3<D>& v)
      : a(Plus(n.x, v.x, n.y, v.y)), b(Minus(n.y, v.x, n.x, v.y)), c(hn::Mul(n.z, v.z)) {}
};

// |(x, y)|^2.
template <class D>
HWY_INLINE hn::Vec<D> Plan2(const Vec3<D>& v) {
  return Plus(v.x, v.x, v.y, v.y);
}

// |(x, y, z)|^2.
template <class D>
HWY_INLINE hn::Vec<D> Norm2(const Vec3<D>& v) {
  return hn::MulAdd(v.z, v.z, Plan2(v));
}

// What the roots of an equation are made of. `real` is also false where w^2 is below `least`, and
// where r2 is zero or so small that its inverse is not finite.
template <class D>
struct Roots {
  hn::Vec<D> w;
  hn::Mask<D> real;

  HWY_INLINE Roots(D d, const Equation<D>& e, hn::Vec<D> r2, hn::Vec<D> least)
      : w(hn::Zero(d)), real(hn::MaskFromVec(hn::Zero(d))) {
    const auto discriminant = hn::NegMulAdd(e.c, e.c, r2);
    const auto above = hn::Sub(hn::MulAdd(hn::Set(d, kTolerance), r2, discriminant), least);
    real = hn::Ge(above, hn::Set(d, std::numeric_limits<double>::min()));
    w = hn::Sqrt(hn::Max(discriminant, hn::Zero(d)));
  }
};

// cos = (-ac -+ bw) / r2, sin = (-bc +- aw) / r2. Divided before w is known: the square root is
// what everything waits for.
template <class D>
struct Yaws {
  hn::Vec<D> cosine1, sine1, cosine2, sine2;

  HWY_INLINE Yaws(const Equation<D>& e, hn::Vec<D> w, hn::Vec<D> minus_by_r2) {
    const auto a = hn::Mul(e.a, minus_by_r2);
    const auto b = hn::Mul(e.b, minus_by_r2);
    const auto ac = hn::Mul(a, e.c);
    const auto bc = hn::Mul(b, e.c);
    cosine1 = hn::MulAdd(b, w, ac);
    cosine2 = hn::NegMulAdd(b, w, ac);
    sine1 = hn::NegMulAdd(a, w, bc);
    sine2 = hn::MulAdd(a, w, bc);
  }
};

// Of w^2, not divided by the lengths of n and D.
template <class D>
HWY_INLINE hn::Vec<D> Least(D d, double min_conditioning, const Vec3<D>& n, const Vec3<D>& v) {
  const auto least2 = hn::Set(d, min_conditioning * min_conditioning);
  return hn::Mul(least2, hn::Mul(Norm2(n), Norm2(v)));
}

// t = depth ray - Rz P, where valid; a NaN for the cosine elsewhere.
template <class D>
HWY_INLINE void StorePoses(D d, hn::Mask<D> valid, hn::Vec<D> cosine, hn::Vec<D> sine,
                           hn::Vec<D> depth, const Vec3<D>& ray, const Vec3<D>& point,
                           const AlignedPoseArrays& to, std::size_t i) {
  const auto nan = hn::Set(d, std::numeric_limits<double>::quiet_NaN());
  hn::StoreU(hn::IfThenElse(valid, cosine, nan), d, to.cosine + i);
  hn::StoreU(sine, d, to.sine + i);
  hn::StoreU(hn::MulSub(depth, ray.x, Minus(cosine, point.x, sine, point.y)), d, to.x + i);
  hn::StoreU(hn::MulSub(depth, ray.y, Plus(sine, point.x, cosine, point.y)), d, to.y + i);
  hn::StoreU(hn::MulSub(depth, ray.z, point.z), d, to.z + i);
}

// With N the horizontal part of n = x1 x x2, the depths of up2p.h become, at the roots,
//   l1 = ((n x x2)z Dz -+ w x2z) / |N|^2,   l2 = ((n x x1)z Dz -+ w x1z) / |N|^2.
template <class D>
HWY_INLINE std::size_t Up2p(D d, const Up2pArrays& s, const AlignedPoseArrays& first,
                            const AlignedPoseArrays& second, std::size_t i) {
  const Vec3<D> x1(d, s.ray1, i), p1(d, s.point1, i), x2(d, s.ray2, i), p2(d, s.point2, i);
  const Vec3<D> n(Minus(x1.y, x2.z, x1.z, x2.y), Minus(x1.z, x2.x, x1.x, x2.z),
                  Minus(x1.x, x2.y, x1.y, x2.x));
  const Vec3<D> along = p2 - p1;
  const Equation<D> e(n, along);
  const auto along2 = Plan2(along);
  const auto r2 = hn::Mul(Plan2(n), along2);  // sooner than a^2 + b^2
  const Roots<D> roots(d, e, r2, Least(d, s.min_conditioning, n, along));
  const auto minus_by_r2 = hn::Div(hn::Set(d, -1.0), r2);
  const Yaws<D> yaws(e, roots.w, minus_by_r2);
  const auto minus_by_n2 = hn::Mul(minus_by_r2, along2);
  const auto mean1 = hn::Mul(Minus(n.x, x2.y, n.y, x2.x), along.z);
  const auto mean2 = hn::Mul(Minus(n.x, x1.y, n.y, x1.x), along.z);
  const auto half1 = hn::Mul(roots.w, x2.z);
  const auto half2 = hn::Mul(roots.w, x1.z);
  // Not yet divided, of the opposite sign.
  const auto first1 = hn::Sub(half1, mean1), first2 = hn::Sub(half2, mean2);
  const auto second1 = hn::Add(half1, mean1), second2 = hn::Add(half2, mean2);
  const auto zero = hn::Zero(d);
  const auto valid1 = hn::And(roots.real, hn::Lt(hn::Max(first1, first2), zero));
  const auto valid2 = hn::And(roots.real, hn::Gt(hn::Min(second1, second2), zero));
  StorePoses(d, valid1, yaws.cosine1, yaws.sine1, hn::Mul(first1, minus_by_n2), x1, p1, first, i);
  StorePoses(d, valid2, yaws.cosine2, yaws.sine2, hn::Neg(hn::Mul(second1, minus_by_n2)), x1, p1,
             second, i);
  return hn::CountTrue(d, roots.real);
}

template <class D>
HWY_INLINE std::size_t Up1p1l(D d, const Up1p1lArrays& s, const AlignedPoseArrays& first,
                              const AlignedPoseArrays& second, std::size_t i) {
  const Vec3<D> x(d, s.ray, i), p(d, s.point, i), n(d, s.plane_normal, i);
  const Vec3<D> along(d, s.line_direction, i);
  const Equation<D> e(n, along);
  const auto r2 = hn::Mul(Plan2(n), Plan2(along));  // sooner than a^2 + b^2
  const Roots<D> roots(d, e, r2, Least(d, s.min_conditioning, n, along));
  const auto n_dot_x = hn::MulAdd(n.x, x.x, Plus(n.y, x.y, n.z, x.z));
  const auto product = hn::Mul(r2, n_dot_x);
  const auto minus_inverse = hn::Div(hn::Set(d, -1.0), product);
  const Yaws<D> yaws(e, roots.w, hn::Mul(minus_inverse, n_dot_x));
  const auto minus_by_n_dot_x = hn::Mul(minus_inverse, r2);
  const Equation<D> height(n, Vec3<D>(d, s.line_point, i) - p);  // -n . Rz (P - L)
  const auto depth = [&](hn::Vec<D> cosine, hn::Vec<D> sine) {
    return hn::Mul(hn::MulAdd(height.a, cosine, hn::MulAdd(height.b, sine, height.c)),
                   minus_by_n_dot_x);
  };
  const auto depth1 = depth(yaws.cosine1, yaws.sine1);
  const auto depth2 = depth(yaws.cosine2, yaws.sine2);
  const auto solvable =
      hn::And(roots.real, hn::Ge(hn::Abs(product), hn::Set(d, std::numeric_limits<double>::min())));
  const auto valid1 = hn::And(solvable, hn::Gt(depth1, hn::Zero(d)));
  const auto valid2 = hn::And(solvable, hn::Gt(depth2, hn::Zero(d)));
  StorePoses(d, valid1, yaws.cosine1, yaws.sine1, depth1, x, p, first, i);
  StorePoses(d, valid2, yaws.cosine2, yaws.sine2, depth2, x, p, second, i);
  return hn::CountTrue(d, roots.real);
}

// Whole vectors, then the rest one by one, because the arrays have no padding to read.
std::size_t Up2pKernel(const Up2pArrays& samples, const AlignedPoseArrays& first,
                       const AlignedPoseArrays& second) {
  const hn::ScalableTag<double> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t conditioned = 0;
  std::size_t i = 0;
  for (; i + lanes <= samples.count; i += lanes) conditioned += Up2p(d, samples, first, second, i);
  const hn::CappedTag<double, 1> one;
  for (; i < samples.count; ++i) conditioned += Up2p(one, samples, first, second, i);
  return conditioned;
}

std::size_t Up1p1lKernel(const Up1p1lArrays& samples, const AlignedPoseArrays& first,
                         const AlignedPoseArrays& second) {
  const hn::ScalableTag<double> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t conditioned = 0;
  std::size_t i = 0;
  for (; i + lanes <= samples.count; i += lanes)
    conditioned += Up1p1l(d, samples, first, second, i);
  const hn::CappedTag<double, 1> one;
  for (; i < samples.count; ++i) conditioned += Up1p1l(one, samples, first, second, i);
  return conditioned;
}

}  // namespace HWY_NAMESPACE
}  // namespace maploc
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace maploc {

HWY_EXPORT(Up2pKernel);
HWY_EXPORT(Up1p1lKernel);

std::size_t SolveUp2pBatch(const Up2pArrays& samples, const AlignedPoseArrays& first,
                           const AlignedPoseArrays& second) {
  return HWY_DYNAMIC_DISPATCH(Up2pKernel)(samples, first, second);
}

std::size_t SolveUp1p1lBatch(const Up1p1lArrays& samples, const AlignedPoseArrays& first,
                             const AlignedPoseArrays& second) {
  return HWY_DYNAMIC_DISPATCH(Up1p1lKernel)(samples, first, second);
}

}  // namespace maploc
#endif  // HWY_ONCE
