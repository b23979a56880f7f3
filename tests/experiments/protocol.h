// The paper's synthetic protocol, section V.A: f = 500 px, points and lines in the cube [-1, 1]^3,
// a camera 3 to 5 m away, 1 px of noise, a threshold of 3 px, 100 iterations.
#pragma once

#include "mapstore/geometry/gravity.h"
#include "tests/experiments/setting.h"

namespace maploc::experiments {

inline constexpr double kDegree = 3.14159265358979323846 / 180.0;
// The wire refuses a gravity sigma of zero, so an exact gravity is sent with the smallest that the
// product tells from zero.
inline constexpr double kLeastGravitySigmaRad = kMinGravitySigmaRad;

struct PaperCell {
  int inliers = 10;           // points, and as many lines
  double outlier_rate = 0.0;  // of all matches of a kind
  double noise_px = 1.0;
  double gravity_noise_deg = 0.0;  // the sigma sent is the same, at least kLeastGravitySigmaRad
  double threshold_px = 3.0;
};

// Exactly 100 iterations (no stop rule), no fallback; outliers by wrong association, as the paper
// makes them; the refinement is told the noise's sigma.
Setting PaperSetting(const std::string& experiment, const PaperCell& cell);

}  // namespace maploc::experiments
