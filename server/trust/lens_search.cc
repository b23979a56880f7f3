#include "server/trust/lens_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "mapstore/geometry/gravity.h"
#include "server/ransac/estimator.h"
#include "server/solvers/reprojection.h"

namespace maploc {
namespace {

// Least gain of support, in shares and in features. Correct queries: at most 9%, and 18% where this
// is 1.5 features. Through a focal length 30% off to twice as long: mostly 20% and more
// (MEASUREMENTS.md).
constexpr double kClearGain = 0.15;
// The same where the lens explains the gravity that contradicts the pose. The pose had two degrees
// more of freedom. Of 2964 answers with a gravity turned by 3 to 30 degrees 8 gain more.
constexpr double kClearGainWithGravity = 0.1;
constexpr double kLeastGain = 3.0;
// Share of the points. Half of the correct queries of `euroc_v101` explain more, and 42 of its 44
// wrong answers through a wrong focal length less.
constexpr double kExplainsEnough = 0.45;

// Logarithms of the focal length over the sent one. Twice as many, from half to double, find one
// more of 96 wrong answers and take twice the time. Smaller errors are lens_fit's.
constexpr std::array kLogScales = {-0.6, -0.3, 0.3, 0.6};
// Shifts of the principal point in sent focal lengths, at right angles to gravity. A step less than
// four degrees, which a pose can take up.
constexpr std::array kShifts = {-0.24, -0.18, -0.12, -0.06, 0.0, 0.06, 0.12, 0.18, 0.24};
constexpr double kLargestShift = 0.3;
// Where gravity does not contradict the pose. Two steps, because others cost too much time.
constexpr std::array kLevelShifts = {-0.18, 0.18};

constexpr std::size_t kEnoughPoints = 200;
// Finds samples of two inliers by 0.996 where three of ten points agree.
constexpr int kIterations = 60;
constexpr std::uint64_t kSeed = 1;
// A consensus with less than this share of the needed support is not refined.
constexpr double kNearly = 0.7;

// What is true of the lens, against the sent one, in the image.
struct Lens {
  double log_scale = 0.0;                           // of the focal length
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // of the principal point, sent focal lengths
};

PoseProblem SomePoints(const PoseProblem& problem, bool has_gravity) {
  PoseProblem some = problem;
  some.has_gravity = has_gravity;
  some.lines.clear();
  some.points.clear();
  const std::size_t step = 1 + problem.points.size() / kEnoughPoints;
  for (std::size_t i = 0; i < problem.points.size(); i += step) {
    some.points.push_back(problem.points[i]);
  }
  return some;
}

// Points that it cannot see are left out.
PoseProblem SeenThrough(const Lens& lens, const PoseProblem& problem, const Camera& camera) {
  PoseProblem seen = problem;
  seen.points.clear();
  seen.focal_length_px *= std::exp(lens.log_scale);
  const Eigen::Vector2d centre = camera.principal_point_px();
  const Eigen::Vector2d moved = centre + camera.MeanFocalLengthPx() * lens.shift;
  for (PointCorrespondence point : problem.points) {
    const auto pixel = camera.Project(point.normalized.homogeneous());
    if (!pixel) continue;
    const auto normalized = camera.Normalize(centre + std::exp(-lens.log_scale) * (*pixel - moved));
    if (!normalized) continue;
    point.normalized = *normalized;
    seen.points.push_back(point);
  }
  return seen;
}

// As RANSAC scores: a feature at the threshold is worth 0, one without error 1.
double Support(const PoseProblem& problem, const Rigid3& camera_from_map, double threshold_px) {
  const PoseMatrix pose(camera_from_map);
  const double threshold = threshold_px / problem.focal_length_px;
  double support = 0.0;
  for (const PointCorrespondence& point : problem.points) {
    Eigen::Vector2d error;
    if (!PointReprojection(pose, point, &error, nullptr)) continue;
    support += std::max(0.0, 1.0 - error.squaredNorm() / (threshold * threshold));
  }
  return support;
}

bool HasPoseWith(const PoseProblem& problem, double needed, double threshold_px) {
  RansacOptions options;
  options.strategy = problem.has_gravity ? Strategy::k2P : Strategy::kP3P;
  options.fall_back = false;
  options.max_reprojection_error_px = threshold_px;
  options.max_iterations = kIterations;
  options.seed = kSeed;
  const Consensus consensus = EstimateConsensus(problem, options);
  if (!consensus.found || consensus.score < kNearly * needed) return false;
  RefineOptions refine;
  refine.max_reprojection_error_px = threshold_px;
  const RefinedPose pose = RefinePose(problem, consensus.camera_from_map, refine);
  return pose.converged && Support(problem, pose.camera_from_map, threshold_px) > needed;
}

// The horizontal axis of the image.
Eigen::Vector2d AcrossGravity(const PoseProblem& problem) {
  const Eigen::Vector3d& gravity = problem.gravity_in_camera;
  return Eigen::Vector2d(gravity.y(), -gravity.x()).normalized();
}

// The turn about that axis by which the pose contradicts gravity.
double TurnAcrossGravity(const PoseProblem& problem, const RefinedPose& pose) {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  axis.head<2>() = AcrossGravity(problem);
  const Eigen::Vector3d& sent = problem.gravity_in_camera;
  const Eigen::Vector3d turned = axis.cross(sent);
  const Eigen::Vector3d difference = GravityInCamera(pose.camera_from_map.rotation) - sent;
  return turned.dot(difference) / turned.squaredNorm();
}

std::vector<Lens> OtherFocalLengths() {
  std::vector<Lens> lenses;
  for (const double log_scale : kLogScales) lenses.push_back({.log_scale = log_scale});
  return lenses;
}

// The shift along gravity is known from the contradiction but for its sign; the other is free.
std::vector<Lens> LensesThatExplainGravity(const PoseProblem& problem, const RefinedPose& pose) {
  std::vector<Lens> lenses = OtherFocalLengths();
  const double along = std::tan(TurnAcrossGravity(problem, pose));
  const Eigen::Vector2d across = AcrossGravity(problem);
  const Eigen::Vector2d down(-across.y(), across.x());
  for (const double signed_along : {-along, along}) {
    for (const double shift : kShifts) {
      const Eigen::Vector2d moved = shift * across + signed_along * down;
      if (moved.norm() <= kLargestShift) lenses.push_back({.shift = moved});
    }
  }
  return lenses;
}

std::vector<Lens> LensesToTry(const PoseProblem& problem, const RefinedPose& pose,
                              bool gravity_rejected) {
  if (gravity_rejected) return LensesThatExplainGravity(problem, pose);
  const int explained = std::accumulate(pose.point_inliers.begin(), pose.point_inliers.end(), 0);
  if (explained >= kExplainsEnough * static_cast<double>(problem.points.size())) return {};
  std::vector<Lens> lenses = OtherFocalLengths();
  if (!problem.has_gravity) return lenses;
  for (const double shift : kLevelShifts) {
    lenses.push_back({.shift = shift * AcrossGravity(problem)});
  }
  return lenses;
}

}  // namespace

bool AgreesBetterThroughAnotherLens(const PoseProblem& problem, const RefinedPose& pose,
                                    const Camera& camera, bool gravity_rejected,
                                    double max_reprojection_error_px) {
  if (camera.IsWide()) return false;
  const PoseProblem some = SomePoints(problem, problem.has_gravity || gravity_rejected);
  const double support = Support(some, pose.camera_from_map, max_reprojection_error_px);
  const double gain = gravity_rejected ? kClearGainWithGravity : kClearGain;
  const double needed = support + std::max(gain * support, kLeastGain);
  return std::ranges::any_of(LensesToTry(problem, pose, gravity_rejected), [&](const Lens& lens) {
    return HasPoseWith(SeenThrough(lens, some, camera), needed, max_reprojection_error_px);
  });
}

}  // namespace maploc
