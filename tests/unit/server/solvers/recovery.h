// How well a solver recovers the poses that its problems were made from.
#pragma once

#include <algorithm>
#include <functional>
#include <iostream>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/synthetic_problem.h"
#include "tests/unit/server/solvers/upright_scene.h"

namespace maploc::testing {

inline constexpr int kManyProblems = 100000;
inline constexpr double kAllButFive = 0.99995;  // of so many
inline constexpr int kSeeds = 3;

// Rotation error of the best of `count` poses; pi when there is none.
inline double BestRotationError(const Rigid3* poses, int count, const Rigid3& truth) {
  double best = std::numbers::pi;
  for (int i = 0; i < count; ++i) {
    best = std::min(best, ComparePoses(poses[i], truth).rotation_rad);
  }
  return best;
}

inline double BestPositionError(const Rigid3* poses, int count, const Rigid3& truth) {
  double best = 1e300;
  for (int i = 0; i < count; ++i) best = std::min(best, ComparePoses(poses[i], truth).position);
  return best;
}

// Of the best of `count` poses by rotation, and of the best by position.
inline PoseError BestError(const Rigid3* poses, int count, const Rigid3& truth) {
  return {BestRotationError(poses, count, truth), BestPositionError(poses, count, truth)};
}

// An entry a problem.
struct Errors {
  std::vector<double> rotation_rad;
  std::vector<double> position;

  void Add(const PoseError& error) {
    rotation_rad.push_back(error.rotation_rad);
    position.push_back(error.position);
  }
};

// `make_and_solve` is called with 0, 1, ... problems - 1.
inline Errors ErrorsOver(int problems, const std::function<PoseError(int)>& make_and_solve) {
  Errors errors;
  for (int i = 0; i < problems; ++i) errors.Add(make_and_solve(i));
  return errors;
}

inline double Percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

// A pose is missed when none of those found is nearer than this. (Near a double root an answer may
// be off by the square root of its rounding, and the solvers clamp a double root within 1e-5.)
inline constexpr double kMissedRad = 1e-5;

// What is asked of a solver, and printed for its README.
struct ErrorSummary {
  int missed = 0;
  double median = 0.0, percent99 = 0.0, percent999 = 0.0, worst = 0.0;
};

inline ErrorSummary Summarize(const std::vector<double>& rotation_errors) {
  ErrorSummary summary;
  for (const double error : rotation_errors) summary.missed += error > kMissedRad ? 1 : 0;
  summary.median = Percentile(rotation_errors, 0.5);
  summary.percent99 = Percentile(rotation_errors, 0.99);
  summary.percent999 = Percentile(rotation_errors, 0.999);
  summary.worst = Percentile(rotation_errors, 1.0);
  std::cout << rotation_errors.size() << " problems, rotation error: median " << summary.median
            << ", 99% " << summary.percent99 << ", 99.9% " << summary.percent999 << ", worst "
            << summary.worst << ", missed " << summary.missed << std::endl;
  return summary;
}

// At most so much; what is not stated is not asked for.
struct RotationBounds {
  double percent99_rad = std::numeric_limits<double>::infinity();
  double percent999_rad = std::numeric_limits<double>::infinity();
};

// No pose is missed, and the bounds hold. Prints the summary.
inline ErrorSummary ExpectRecovered(const Errors& errors, const RotationBounds& bounds) {
  const ErrorSummary summary = Summarize(errors.rotation_rad);
  EXPECT_EQ(summary.missed, 0);
  EXPECT_LE(summary.percent99, bounds.percent99_rad);
  EXPECT_LE(summary.percent999, bounds.percent999_rad);
  return summary;
}

// A thousand scenes at each quarter turn, where cosine and sine are 0 or 1.
inline void ExpectNoYawIsSpecial(
    Random& random, const std::function<PoseError(const UprightScene&)>& make_and_solve) {
  const double cosines[] = {1, 0, -1, 0};
  const double sines[] = {0, 1, 0, -1};
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (int i = 0; i < 1000; ++i) {
      const UprightScene scene = MakeSceneWithYaw(cosines[quarter], sines[quarter], random);
      EXPECT_LT(make_and_solve(scene).rotation_rad, 1e-8)
          << 90 * quarter << " degrees, problem " << i;
    }
  }
}

// How far each of `count` poses is from the nearest of `others`, added to `differences`.
inline void AddDifferences(const Rigid3* poses, int count, const std::vector<Rigid3>& others,
                           std::vector<double>* differences) {
  for (int k = 0; k < count; ++k) {
    const int size = static_cast<int>(others.size());
    differences->push_back(BestRotationError(others.data(), size, poses[k]));
  }
}

}  // namespace maploc::testing
