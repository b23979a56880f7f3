#include "server/refinement/refine.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "mapstore/geometry/gravity.h"
#include "server/refinement/cost_functions.h"
#include "server/refinement/covariance.h"
#include "server/solvers/reprojection.h"

namespace maploc {
namespace {

// Cauchy's loss at this many sigmas: a true inlier hardly feels it, a wrong match inside of the
// threshold does.
constexpr double kLossScaleSigmas = 2.5;
constexpr int kMaxSolverIterations = 20;

// The map moved to `origin`, so that a map 500 km from its own keeps its digits in the equations.
PoseProblem Recentred(const PoseProblem& problem, const Eigen::Vector3d& origin) {
  PoseProblem moved = problem;
  for (PointCorrespondence& point : moved.points) point.position_in_map -= origin;
  for (LineCorrespondence& line : moved.lines) {
    line.segment_in_map.start -= origin;
    line.segment_in_map.end -= origin;
  }
  return moved;
}

Eigen::Vector3d SomeLandmark(const PoseProblem& problem) {
  if (!problem.points.empty()) return problem.points.front().position_in_map;
  if (!problem.lines.empty()) return problem.lines.front().segment_in_map.start;
  return Eigen::Vector3d::Zero();
}

// Enough to determine the pose: gravity is worth one feature.
int MinFeatures(Refinement mode) { return mode == Refinement::k6Dof ? 3 : 2; }

class Refiner {
 public:
  Refiner(const PoseProblem& problem, const RefineOptions& options)
      : problem_(problem),
        options_(options),
        mode_(problem.has_gravity ? options.mode : Refinement::k6Dof),
        sigma_(options.pixel_sigma / problem.focal_length_px) {}

  RefinedPose Run(Rigid3 pose) {
    RefinedPose refined;
    InlierFlags inliers = Inliers(pose);
    for (int round = 0; round < options_.max_rounds; ++round) {
      if (inliers.count < MinFeatures(mode_) || !Solve(inliers, &pose)) break;
      refined.converged = true;
      InlierFlags next = Inliers(pose);
      const bool stays = next.points == inliers.points && next.lines == inliers.lines;
      inliers = std::move(next);
      if (stays) break;
    }
    refined.converged = refined.converged && inliers.count >= MinFeatures(mode_);
    refined.camera_from_map = pose;
    refined.covariance = Covariance(pose, inliers);
    refined.point_inliers = std::move(inliers.points);
    refined.line_inliers = std::move(inliers.lines);
    if (problem_.has_gravity) {
      refined.gravity_disagreement_rad =
          AngleBetween(GravityInCamera(pose.rotation), problem_.gravity_in_camera);
    }
    return refined;
  }

 private:
  InlierFlags Inliers(const Rigid3& pose) const {
    return FindInliers(problem_, pose, options_.max_reprojection_error_px);
  }

  bool Solve(const InlierFlags& inliers, Rigid3* pose) const {
    const RotationChart chart = mode_ == Refinement::k4Dof
                                    ? YawChart(pose->rotation, problem_.gravity_in_camera)
                                    : FreeChart(pose->rotation);
    double turn[3] = {0, 0, 0};
    Eigen::Vector3d translation = pose->translation;
    ceres::Problem::Options ownership;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::CauchyLoss loss(LossScale());
    ceres::Problem least_squares(ownership);
    AddFeatures(inliers, chart, &loss, turn, translation.data(), &least_squares);
    if (mode_ == Refinement::kAuto) {
      const double gravity_sigma = std::max(problem_.gravity_sigma_rad, kMinGravitySigmaRad);
      least_squares.AddResidualBlock(
          MakeGravityCost(chart, problem_.gravity_in_camera, gravity_sigma).release(), nullptr,
          turn);
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    solver.max_num_iterations = kMaxSolverIterations;
    solver.function_tolerance = 1e-8;
    solver.parameter_tolerance = 1e-9;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &least_squares, &summary);
    if (!summary.IsSolutionUsable() || !translation.allFinite()) return false;
    pose->rotation = Eigen::Quaterniond(chart.Rotation(turn)).normalized();
    pose->translation = translation;
    return true;
  }

  // Where gravity is held, its error shows in the residuals of good matches, in sigmas of a pixel.
  double LossScale() const {
    const double from_gravity =
        mode_ == Refinement::k4Dof ? problem_.gravity_sigma_rad / sigma_ : 0.0;
    return kLossScaleSigmas * std::hypot(1.0, from_gravity);
  }

  void AddFeatures(const InlierFlags& inliers, const RotationChart& chart,
                   ceres::LossFunction* loss, double* turn, double* translation,
                   ceres::Problem* least_squares) const {
    for (std::size_t i = 0; i < problem_.points.size(); ++i) {
      if (inliers.points[i] == 0) continue;
      least_squares->AddResidualBlock(MakePointCost(chart, problem_.points[i], sigma_).release(),
                                      loss, turn, translation);
    }
    for (std::size_t i = 0; i < problem_.lines.size(); ++i) {
      if (inliers.lines[i] == 0) continue;
      least_squares->AddResidualBlock(MakeLineCost(chart, problem_.lines[i], sigma_).release(),
                                      loss, turn, translation);
    }
  }

  PoseCovariance Covariance(const Rigid3& pose, const InlierFlags& inliers) const {
    const PoseMatrix matrix(pose);
    const Eigen::Matrix<double, 6, 6> information =
        PoseInformation(problem_, matrix, inliers, sigma_);
    const Eigen::Vector3d& gravity = problem_.gravity_in_camera;
    const double gravity_sigma = problem_.gravity_sigma_rad;
    switch (mode_) {
      case Refinement::kAuto:
        return CovarianceOfMapFromCamera(
            matrix, SoftGravityCovariance(information, gravity, gravity_sigma));
      case Refinement::k4Dof:
        return CovarianceOfMapFromCamera(
            matrix, HeldGravityCovariance(information, gravity, gravity_sigma));
      case Refinement::k6Dof:
        break;
    }
    return CovarianceOfMapFromCamera(matrix, FreeCovariance(information));
  }

  const PoseProblem& problem_;
  const RefineOptions& options_;
  const Refinement mode_;
  const double sigma_;  // of a coordinate, plane z = 1
};

}  // namespace

RefinedPose RefinePose(const PoseProblem& problem, const Rigid3& camera_from_map,
                       const RefineOptions& options) {
  const Eigen::Vector3d origin = SomeLandmark(problem);
  const PoseProblem moved = Recentred(problem, origin);
  const Rigid3 start = {camera_from_map.rotation, camera_from_map * origin};
  RefinedPose refined = Refiner(moved, options).Run(start);
  Rigid3& pose = refined.camera_from_map;
  pose.translation -= pose.rotation * origin;
  return refined;
}

}  // namespace maploc
