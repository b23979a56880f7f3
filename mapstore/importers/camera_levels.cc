#include "mapstore/importers/camera_levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "mapstore/base/angles.h"
#include "mapstore/base/median.h"
#include "mapstore/base/random.h"

namespace maploc {
namespace {

// A photo further off level than this was held otherwise (portrait, on the side).
constexpr double kMaxOffLevelRad = 10 * kRadPerDeg;
// What photos share: hands and mounts are level to a degree or two.
constexpr double kSharedSigmaRad = 1.5 * kRadPerDeg;
// People look about level; weak, for it is all that there is about one-sided photos' tilt.
constexpr double kPitchHabitSigmaRad = 25 * kRadPerDeg;
// Photos of one hand are held alike, so that they count as half as many; and no set was seen whose
// own scatter below a degree was to be believed (MEASUREMENTS.md: levels against verticals).
constexpr double kLikeness = 2.0;
constexpr double kLeastOffLevelRad = 1.0 * kRadPerDeg;
constexpr double kTukey = 4.685;  // 95% efficient for normal noise
constexpr int kPairs = 500;

struct Axes {
  std::vector<Eigen::Vector3d> x, y, z;  // of the cameras, in source
  Eigen::Vector3d mean_y = Eigen::Vector3d::Zero();
};

Axes TakeAxes(std::span<const Eigen::Quaterniond> camera_from_source) {
  Axes axes;
  for (const Eigen::Quaterniond& rotation : camera_from_source) {
    const Eigen::Matrix3d in_source = rotation.toRotationMatrix().transpose();
    axes.x.push_back(in_source.col(0));
    axes.y.push_back(in_source.col(1));
    axes.z.push_back(in_source.col(2));
    axes.mean_y += in_source.col(1) / static_cast<double>(camera_from_source.size());
  }
  return axes;
}

double OffLevel(const Eigen::Vector3d& x_axis, const Eigen::Vector3d& down) {
  // Rounding can take a product of unit vectors beyond 1, where asin is not a number.
  return std::asin(std::clamp(x_axis.dot(down), -1.0, 1.0));
}

double Cost(const Axes& axes, const Eigen::Vector3d& down) {
  double cost = 0.0;
  for (const Eigen::Vector3d& x : axes.x) {
    cost += std::pow(std::min(std::abs(OffLevel(x, down)), kMaxOffLevelRad), 2);
  }
  return cost;
}

// The direction that most photos are level with, among those that two photos propose and the y
// axes' mean; on the y axes' side.
Eigen::Vector3d FindStart(const Axes& axes) {
  Eigen::Vector3d best =
      axes.mean_y.norm() > 1e-6 ? Eigen::Vector3d(axes.mean_y.normalized()) : axes.y[0];
  double best_cost = Cost(axes, best);
  // A fixed seed: the same model always gives the same map.
  Random random(1);
  const auto count = static_cast<std::uint32_t>(axes.x.size());
  for (int i = 0; i < kPairs; ++i) {
    Eigen::Vector3d down = axes.x[random.Below(count)].cross(axes.x[random.Below(count)]);
    if (down.norm() < 0.1) continue;  // within 6 degrees of each other: their noise decides
    down.normalize();
    const double cost = Cost(axes, down);
    if (cost < best_cost) {
      best = down;
      best_cost = cost;
    }
  }
  return best.dot(axes.mean_y) < 0 ? Eigen::Vector3d(-best) : best;
}

// The normal equations of one step; unknowns are g's move in its tangent plane and what photos
// share.
struct Step {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double squares = 0.0;  // weighted, of the residuals
  double weight = 0.0;

  void Add(const Eigen::Vector3d& row, double residual, double w) {
    information += w * row * row.transpose();
    gradient += w * row * residual;
  }
};

double Scale(const Axes& axes, const Eigen::Vector3d& down, double shared) {
  std::vector<double> off;
  for (const Eigen::Vector3d& x : axes.x) {
    const double residual = std::abs(OffLevel(x, down) - shared);
    if (residual < kMaxOffLevelRad) off.push_back(residual);
  }
  if (off.empty()) return kMaxOffLevelRad;
  return std::max(1.4826 * Median(off), kLeastOffLevelRad);
}

Step AddPhotos(const Axes& axes, const Eigen::Vector3d& down,
               const Eigen::Matrix<double, 3, 2>& basis, double shared, double scale) {
  Step step;
  for (const Eigen::Vector3d& x : axes.x) {
    const double residual = OffLevel(x, down) - shared;
    // Tukey's weight: photos that were held otherwise (portrait among landscape) count nothing.
    const double far = residual / (kTukey * scale);
    if (std::abs(far) >= 1.0) continue;
    const double weight = std::pow(1.0 - far * far, 2);
    const Eigen::Vector2d tangent = basis.transpose() * x;
    // x . g = sin(b + e), so for small angles e changes by x with g and by -1 with b.
    step.Add({tangent.x(), tangent.y(), -1.0}, residual, weight);
    step.squares += weight * residual * residual;
    step.weight += weight;
  }
  return step;
}

// The habits, as measurements in units of the photos' variance.
void AddHabits(const Axes& axes, const Eigen::Vector3d& down,
               const Eigen::Matrix<double, 3, 2>& basis, double shared, double variance,
               Step& step) {
  step.Add({0, 0, 1}, shared, variance / (kSharedSigmaRad * kSharedSigmaRad));
  // Without a mean y axis there is no habit to go by; a right angle then says "anywhere".
  const bool looks_level = axes.mean_y.norm() > 0.5;
  const Eigen::Vector3d expected = looks_level ? axes.mean_y.normalized() : down;
  const double sigma = looks_level ? kPitchHabitSigmaRad : std::numbers::pi / 2;
  const Eigen::Vector2d residual = basis.transpose() * (down - expected);
  step.Add({1, 0, 0}, residual.x(), variance / (sigma * sigma));
  step.Add({0, 1, 0}, residual.y(), variance / (sigma * sigma));
}

DirectionFit Fit(const Axes& axes) {
  DirectionFit fit{FindStart(axes), {}};
  double shared = 0.0;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Matrix<double, 3, 2> basis = TangentBasis(fit.direction);
    Step step = AddPhotos(axes, fit.direction, basis, shared, Scale(axes, fit.direction, shared));
    const double freedom = std::max(step.weight - 2.0, 1.0);
    const double variance = std::max(step.squares / freedom, kLeastOffLevelRad * kLeastOffLevelRad);
    AddHabits(axes, fit.direction, basis, shared, variance, step);
    const Eigen::Matrix3d covariance =
        kLikeness * SmallSampleFactor(freedom) * variance * step.information.inverse();
    fit.covariance = basis * covariance.topLeftCorner<2, 2>() * basis.transpose();
    const Eigen::Vector3d move = -step.information.ldlt().solve(step.gradient);
    fit.direction = (fit.direction + basis * move.head<2>()).normalized();
    shared += move.z();
  }
  return fit;
}

// Whether the axes lie along one line, up to sign: nine tenths of their scatter.
bool AreParallel(const std::vector<Eigen::Vector3d>& axes) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& axis : axes) scatter += axis * axis.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(2) > 0.9 * static_cast<double>(axes.size());
}

}  // namespace

CameraLevels FitCameraLevels(std::span<const Eigen::Quaterniond> camera_from_source) {
  const Axes axes = TakeAxes(camera_from_source);
  CameraLevels levels;
  levels.down_in_source = Fit(axes);
  levels.looks_around = !AreParallel(axes.x);
  const double steepest = std::cos(70 * kRadPerDeg);
  const auto upright = std::count_if(axes.y.begin(), axes.y.end(), [&](const Eigen::Vector3d& y) {
    return y.dot(levels.down_in_source.direction) > steepest;
  });
  levels.upright_share = static_cast<double>(upright) / static_cast<double>(axes.y.size());
  return levels;
}

std::string DescribeHolding(std::span<const Eigen::Quaterniond> camera_from_source,
                            const CameraLevels& levels) {
  const Axes axes = TakeAxes(camera_from_source);
  const bool x_parallel = AreParallel(axes.x);
  const bool z_parallel = AreParallel(axes.z);
  if (z_parallel && (x_parallel || levels.AgreeOnSign())) {
    return "all photos look in the same direction, so their levels do not determine the tilt in "
           "that direction";
  }
  if (z_parallel) return "the photos look straight down or up (a nadir flight?)";
  if (x_parallel) {
    return "the photos turn about their x axis (portrait photos, the camera rolled by 90 degrees?)";
  }
  if (levels.AgreeOnSign()) return "the photos are too few, or not level enough";
  return "the photos are held in different ways (landscape, portrait, upside down?)";
}

}  // namespace maploc
