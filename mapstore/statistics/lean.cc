#include "mapstore/statistics/lean.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "mapstore/base/median.h"
#include "mapstore/geometry/gravity.h"

namespace maploc {
namespace {

// Fewer queries of a robot do not count: one pose may be wrong.
constexpr std::int64_t kMinQueries = 5;
// A single robot may be mounted askew, so this many robots are needed.
constexpr std::int64_t kMinRobots = 2;
// Standard deviation of the robots' independent mounting errors (0.5 degrees). The scatter of few
// robots is not taken to be below it and what their queries' scatter leaves in their medians.
constexpr double kRobotSigmaRad = 0.0087;
// A smaller lean (1 degree) is ignored, however certain.
constexpr double kMinLeanRad = 0.0175;

constexpr double kChiSquare2At95 = 5.991465;
// So far outside its interval is one level map in ten thousand: sqrt(18.42 / 5.99).
constexpr double kBeyondInterval = 1.75;

// By coordinate: robust against the queries whose pose is wrong.
Eigen::Vector2d MedianTilt(const std::vector<Eigen::Vector2d>& tilts) {
  std::vector<double> x;
  std::vector<double> y;
  for (const Eigen::Vector2d& tilt : tilts) {
    x.push_back(tilt.x());
    y.push_back(tilt.y());
  }
  return {Median(std::move(x)), Median(std::move(y))};
}

// Of the median in one coordinate, from the queries' scatter about it, which is robust too. One
// query of n is the median itself: n - 1 deviations are left.
double VarianceOfMedian(const std::vector<Eigen::Vector2d>& tilts, const Eigen::Vector2d& median) {
  std::vector<double> deviations;
  for (const Eigen::Vector2d& tilt : tilts) {
    for (const double deviation : tilt - median) {
      if (deviation != 0.0) deviations.push_back(std::abs(deviation));
    }
  }
  if (deviations.empty()) return 0.0;
  const double sigma = kSigmaOfMad * Median(std::move(deviations));
  return kMedianVariance * sigma * sigma / static_cast<double>(tilts.size() - 1);
}

// The larger of the robots' own scatter (over both axes) and what is known of it.
double RobotVariance(std::span<const Eigen::Vector2d> tilts, const Eigen::Vector2d& mean,
                     double least_variance) {
  double squares = 0.0;
  for (const Eigen::Vector2d& tilt : tilts) squares += (tilt - mean).squaredNorm();
  const double freedom = std::max(1.0, 2.0 * (static_cast<double>(tilts.size()) - 1.0));
  return std::max(squares / freedom, least_variance);
}

}  // namespace

Lean FindLean(std::span<const RobotTilts> robots) {
  Lean lean;
  std::vector<Eigen::Vector2d> tilts;
  double noise = 0.0;  // sum of the medians' variances
  for (const RobotTilts& robot : robots) {
    const auto queries = static_cast<std::int64_t>(robot.tilts_rad.size());
    if (queries < kMinQueries) continue;
    tilts.push_back(MedianTilt(robot.tilts_rad));
    noise += VarianceOfMedian(robot.tilts_rad, tilts.back());
    lean.queries += queries;
  }
  lean.robots = static_cast<std::int64_t>(tilts.size());
  if (tilts.empty()) return lean;
  const auto count = static_cast<double>(tilts.size());
  for (const Eigen::Vector2d& tilt : tilts) lean.tilt_rad += tilt / count;
  const double mounting = kRobotSigmaRad * kRobotSigmaRad;
  const double variance = RobotVariance(tilts, lean.tilt_rad, mounting + noise / count);
  lean.interval_rad = std::sqrt(kChiSquare2At95 * variance / count);
  const double angle = lean.tilt_rad.norm();
  const bool all_agree = std::all_of(tilts.begin(), tilts.end(), [&](const Eigen::Vector2d& tilt) {
    return (tilt - lean.tilt_rad).norm() < tilt.norm();
  });
  lean.leans = lean.robots >= kMinRobots && angle > kMinLeanRad &&
               angle > kBeyondInterval * lean.interval_rad && all_agree;
  return lean;
}

Eigen::Vector3d GravityOfLean(const Eigen::Vector2d& tilt_rad) {
  const double angle = tilt_rad.norm();
  if (!(angle > 0)) return kGravityInMap;
  const Eigen::Vector3d axis(tilt_rad.x() / angle, tilt_rad.y() / angle, 0.0);
  return Eigen::AngleAxisd(angle, axis) * kGravityInMap;
}

}  // namespace maploc
