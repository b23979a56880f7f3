// A real root of a cubic, as a ratio: the leading coefficient may be zero, and the root infinite.
// Of three real roots it is the outer one on the side where one stands alone, so never one of two
// that coincide while the third does not.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace maploc {

// a x^3 + b x^2 + c x + d.
struct Cubic {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  double d = 0.0;
};

// x = numerator / denominator.
struct HomogeneousRoot {
  double numerator = 0.0;
  double denominator = 1.0;
};

// The cube root of a > 0 to 2e-6: a third of the exponent (the constant is fdlibm's), and two steps
// of Newton. The library's, exact to the last digit, takes longer than all the rest here.
inline double FastCubeRoot(double a) {
  constexpr std::uint64_t kTwoThirdsOfBias = std::uint64_t{715094163} << 32;
  double u = std::bit_cast<double>(std::bit_cast<std::uint64_t>(a) / 3 + kTwoThirdsOfBias);
  for (int i = 0; i < 2; ++i) u = (2.0 / 3) * u + (1.0 / 3) * a / (u * u);
  return u;
}

// The greatest root of 4 y^3 - 3 y = k for 0 <= k <= 1, cos(acos(k) / 3), to 7e-7: a polynomial
// through Chebyshev's nodes.
inline double GreatestOfThree(double k) {
  const double k2 = k * k;
  return (0.8660260610588332 + 0.16661885651503525 * k) +
         k2 * ((-0.04752501393243387 + 0.021899627345142326 * k) +
               k2 * (-0.008966451200155465 + 0.0019473016104158958 * k));
}

// A root of x^3 + b x^2 + c x + d, to 1e-11 of the roots' spread.
inline double OuterRootMonic(double b, double c, double d) {
  const double centre = (-1.0 / 3) * b;
  const double p = c + b * centre;  // t^3 + p t + q = 0, x = centre + t
  const double q = d + centre * (c + centre * (b + centre));
  const double radius = std::sqrt((1.0 / 3) * std::abs(p));
  const double k = std::abs(q) / (2 * radius * radius * radius);
  constexpr double kPureCube = 1e30;  // p t is nothing
  double t;
  if (p < 0 && k <= 1) {
    t = 2 * radius * GreatestOfThree(k);
  } else if (k < kPureCube) {
    // cosh(acosh(k) / 3) or, for p > 0, sinh(asinh(k) / 3).
    const double sign = std::copysign(1.0, p);
    const double u = FastCubeRoot(k + std::sqrt(k * k + sign));
    t = radius * (u - sign / u);
  } else {
    t = std::cbrt(std::abs(q));
  }
  const double x = centre - std::copysign(t, q);
  // One step of Newton doubles the digits, and mends what the shift by the centre has cost.
  const double slope = (3 * x + 2 * b) * x + c;
  const double step = (((x + b) * x + c) * x + d) / slope;
  return slope != 0 ? x - step : x;
}

// REQUIRES: finite coefficients. All zero: the root is not a number.
inline HomogeneousRoot OuterRoot(const Cubic& f) {
  constexpr double kFar = 1e-3;
  if (std::max(std::abs(f.a), std::abs(f.d)) < kFar * (std::abs(f.b) + std::abs(f.c))) {
    // Roots near zero and near infinity: seen from 1 or -1, as x = shift + 1 / z, none is far.
    const double at_plus = f.a + f.b + f.c + f.d;
    const double at_minus = -f.a + f.b - f.c + f.d;
    const double shift = std::abs(at_plus) >= std::abs(at_minus) ? 1.0 : -1.0;
    const double value = shift > 0 ? at_plus : at_minus;
    const double slope = (3 * f.a * shift + 2 * f.b) * shift + f.c;
    const double half_curvature = 3 * f.a * shift + f.b;
    const double z = OuterRootMonic(slope / value, half_curvature / value, f.a / value);
    return {shift * z + 1, z};
  }
  const bool forward = std::abs(f.a) >= std::abs(f.d);
  const double by_lead = 1.0 / (forward ? f.a : f.d);
  const double root =
      OuterRootMonic((forward ? f.b : f.c) * by_lead, (forward ? f.c : f.b) * by_lead,
                     (forward ? f.d : f.a) * by_lead);
  return {forward ? root : 1.0, forward ? 1.0 : root};
}

}  // namespace maploc
