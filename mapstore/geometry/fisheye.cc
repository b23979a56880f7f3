#include "mapstore/geometry/fisheye.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace maploc {

double Bend(const double k[4], double theta_rad) {
  const double t2 = theta_rad * theta_rad;
  return theta_rad * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

double BendSlope(const double k[4], double theta_rad) {
  const double t2 = theta_rad * theta_rad;
  return 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
}

double MaxBendableAngle(const double k[4]) {
  constexpr double kMax = std::numbers::pi - 0.01;
  constexpr double kStep = std::numbers::pi / 180.0;
  double rises = 0.0;
  // The slope can have several zeros, and the first one counts. Bisection alone could find a later
  // one, so it only refines the degree in which the slope changes its sign.
  while (rises < kMax && BendSlope(k, std::min(rises + kStep, kMax)) > 0) rises += kStep;
  if (rises >= kMax) return kMax;
  double falls = std::min(rises + kStep, kMax);
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (rises + falls);
    (BendSlope(k, middle) > 0 ? rises : falls) = middle;
  }
  return rises;
}

std::optional<double> Unbend(const double k[4], double max_theta_rad, double bent) {
  double low = 0.0;
  double high = max_theta_rad;
  if (bent > Bend(k, high)) return std::nullopt;
  double theta = std::min(bent, high);
  // Newton, kept between bounds: near the fold it would overshoot.
  for (int i = 0; i < 100; ++i) {
    const double value = Bend(k, theta) - bent;
    (value > 0 ? high : low) = theta;
    double next = theta - value / BendSlope(k, theta);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = std::abs(next - theta);
    theta = next;
    if (step < 1e-14) break;
  }
  return theta;
}

}  // namespace maploc
