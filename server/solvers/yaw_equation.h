// The one equation behind every upright solver (README.md):
//
//   n . Rz(yaw) D = 0   <=>   A cos + B sin + C = 0
//   A = nx Dx + ny Dy,  B = ny Dx - nx Dy,  C = nz Dz
//
// n is the normal of a plane through the camera's centre (aligned frame), D a direction in the map
// that must lie in that plane.
//
// With r2 = A^2 + B^2 and w = sqrt(r2 - C^2):
//   cos = (-A C -+ B w) / r2,   sin = (-B C +- A w) / r2.
// At most two solutions. Degenerate at w = 0: the plane is perpendicular to the vertical plane
// through D, where the two solutions meet; at A = B = 0 (vertical D or horizontal plane) the yaw is
// unobservable. For unit n and D, w = |det(n, Rz D, up)| is the conditioning: the yaw's error is
// the angular error of n divided by w.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "server/solvers/aligned.h"

namespace maploc {

struct YawEquation {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
};

inline YawEquation MakeYawEquation(const Eigen::Vector3d& n, const Eigen::Vector3d& d) {
  return {n.x() * d.x() + n.y() * d.y(), n.y() * d.x() - n.x() * d.y(), n.z() * d.z()};
}

// n . Rz(yaw) D at a known yaw.
inline double Value(const YawEquation& equation, const Yaw& yaw) {
  return equation.a * yaw.cosine + equation.b * yaw.sine + equation.c;
}

// w^2 before clamping; scales with |n|^2 |D|^2. Needs no yaw, so it can gate before solving.
inline double YawDiscriminant(const YawEquation& equation) {
  return equation.a * equation.a + equation.b * equation.b - equation.c * equation.c;
}

// Whether w = sqrt(discriminant) / (|n| |D|), in [0, 1], is at least `least`: the gate of a sample,
// without root and division. False for a zero n or D.
inline bool IsYawConditioned(const Eigen::Vector3d& n, const Eigen::Vector3d& d, double least) {
  const double scale2 = n.squaredNorm() * d.squaredNorm();
  return YawDiscriminant(MakeYawEquation(n, d)) >= least * least * scale2 && scale2 > 0;
}

// A discriminant negative by rounding or by noise near a double root is taken as zero down to
// -kDoubleRootTolerance r2; that moves the yaw by at most sqrt(kDoubleRootTolerance) = 1e-5 rad.
inline constexpr double kDoubleRootTolerance = 1e-10;

// The two roots without a branch: cos_k = (cosine_mean -+ cosine_half) / r2, sin likewise. `real`
// is false where there is no root; the numbers are then finite and mean nothing.
struct YawRoots {
  double r2 = 0.0;
  double cosine_mean = 0.0;
  double cosine_half = 0.0;
  double sine_mean = 0.0;
  double sine_half = 0.0;
  bool real = false;

  // sign = -1 or 1.
  Yaw Root(double sign, double by_r2) const {
    return {(cosine_mean + sign * cosine_half) * by_r2, (sine_mean + sign * sine_half) * by_r2};
  }
};

inline YawRoots FindYawRoots(const YawEquation& equation) {
  const auto [a, b, c] = equation;
  const double r2 = a * a + b * b;
  const double discriminant = r2 - c * c;
  const double w = std::sqrt(std::max(discriminant, 0.0));
  return {r2, -a * c, b * w, -b * c, -a * w, discriminant >= -kDoubleRootTolerance * r2};
}

}  // namespace maploc
