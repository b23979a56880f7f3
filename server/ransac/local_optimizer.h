// Local optimization. A hypothesis from a minimal sample, and from a gravity that is a degree off,
// fits only part of its inliers; a few steps of robust least squares over the features near it find
// the others. Necessary with real gravity: without it, 1 degree of noise costs five times the
// iterations.
//
// Gauss-Newton on 6 degrees of freedom, gravity as a measurement of its sigma, over features within
// 4 (and gravity's error), 2, 1, 1 thresholds, weighted (1 - e^2 / T^2)^2 (Tukey).
#pragma once

#include <cstdint>
#include <vector>

#include "server/ransac/prepared_problem.h"

namespace maploc {

// Reuses its memory from call to call. Not thread-safe. `prepared` must outlive it.
class LocalOptimizer {
 public:
  // `use_gravity` false: gravity is forgotten.
  LocalOptimizer(const PreparedProblem& prepared, bool use_gravity);

  // One Gauss-Newton step over the features within `threshold` (plane z = 1). Returns false when
  // too few features lie within it or the equations are singular; the pose is then unchanged.
  bool Step(double threshold, PoseMatrix* camera_from_centred);

 private:
  const PreparedProblem& prepared_;
  const bool use_gravity_;
  std::vector<std::uint32_t> places_;
};

}  // namespace maploc
