#include "mapstore/importers/measured_gravity.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "mapstore/base/angles.h"
#include "mapstore/base/median.h"
#include "mapstore/geometry/gravity.h"

namespace maploc {
namespace {

// A phone or drone that moves is some degrees off; further away it measured something else.
constexpr double kMaxOffRad = 15 * kRadPerDeg;
constexpr double kMinShare = 0.7;
// Neighbouring photos are taken in one motion, so that they count as half as many.
constexpr double kLikeness = 2.0;
// A mount's and an accelerometer's constant error, where photos do not look all around.
constexpr double kSharedSigmaRad = 0.2 * kRadPerDeg;

// The measurement with the smallest summed distance to the others, each counted to kMaxOffRad.
Eigen::Vector3d FindMedoid(std::span<const Eigen::Vector3d> directions) {
  // Thousands of photos need no more candidates than this to hold a good one.
  const std::size_t step = directions.size() / 200 + 1;
  Eigen::Vector3d best = directions[0];
  double best_cost = INFINITY;
  for (std::size_t i = 0; i < directions.size(); i += step) {
    double cost = 0.0;
    for (const Eigen::Vector3d& other : directions) {
      cost += std::min(AngleBetween(directions[i], other), kMaxOffRad);
    }
    if (cost < best_cost) {
      best = directions[i];
      best_cost = cost;
    }
  }
  return best;
}

// Those within kMaxOffRad of the medoid and, of these, within three times their median distance:
// 3.5 standard deviations, but a degree at least.
std::vector<Eigen::Vector3d> KeepAgreeing(std::span<const Eigen::Vector3d> directions) {
  const Eigen::Vector3d medoid = FindMedoid(directions);
  std::vector<double> distances;
  for (const Eigen::Vector3d& direction : directions) {
    const double distance = AngleBetween(direction, medoid);
    if (distance <= kMaxOffRad) distances.push_back(distance);
  }
  const double reach = std::clamp(3.0 * Median(distances), 1.0 * kRadPerDeg, kMaxOffRad);
  std::vector<Eigen::Vector3d> kept;
  for (const Eigen::Vector3d& direction : directions) {
    if (AngleBetween(direction, medoid) <= reach) kept.push_back(direction);
  }
  return kept;
}

}  // namespace

std::optional<DirectionFit> FitMeasuredGravity(std::span<const Eigen::Vector3d> down_in_source) {
  if (down_in_source.empty()) return std::nullopt;
  const std::vector<Eigen::Vector3d> kept = KeepAgreeing(down_in_source);
  const auto count = static_cast<double>(kept.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& down : kept) sum += down;
  const bool is_majority = count >= kMinShare * static_cast<double>(down_in_source.size());
  if (count < kMinMeasurements || !is_majority) return std::nullopt;
  const DirectionFit mean{sum.normalized(), {}};
  const Eigen::Matrix<double, 3, 2> basis = TangentBasis(mean.direction);
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector3d& down : kept) {
    const Eigen::Vector2d off = basis.transpose() * down;
    scatter += off * off.transpose();
  }
  // The covariance of a mean of n is the scatter over n (n - 1).
  const double factor = kLikeness * SmallSampleFactor(count - 1) / (count * (count - 1));
  const Eigen::Matrix2d covariance =
      factor * scatter + kSharedSigmaRad * kSharedSigmaRad * Eigen::Matrix2d::Identity();
  return DirectionFit{mean.direction, basis * covariance * basis.transpose()};
}

}  // namespace maploc
