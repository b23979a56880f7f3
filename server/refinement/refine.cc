#include "server/refinement/refine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <ceres/tiny_solver.h>

#include "mapstore/geometry/gravity.h"
#include "server/refinement/covariance.h"
#include "server/refinement/pose_residuals.h"
#include "server/solvers/reprojection.h"

namespace maploc {
namespace {

constexpr int kMaxSolverIterations = 20;
constexpr double kFunctionTolerance = 1e-6;  // change of the sum of squares a residual, in sigmas^2
// TinySolver does not take a step shorter than this share of the parameters, so that a pose some
// metres from its landmarks would stay wrong by 10 times as many nanometres at its own 1e-8.
constexpr double kParameterTolerance = 1e-10;
// The start is close: nearly Gauss-Newton from the first step. At TinySolver's own 1e4 its damping
// leaves a ten thousandth of the error along what the features hardly determine, at every step.
constexpr double kTrustRegionRadius = 1e6;

// The variance of a pose under Cauchy's loss of scale a (in sigmas), as a multiple of that under
// least squares, whose inverse information PoseInformation gives: E[psi^2] / E[psi']^2 of features
// with Gaussian errors in two coordinates (Huber 1964, "Robust estimation of a location parameter",
// in the plane): with e = 2 / a^2 and x ~ Exp(1), E[x / (1 + e x)^2] / E[1 / (1 + e x)^2]^2. This
// fraction is within 0.001 of it for a >= 2; 1.055 at 2.5.
double VarianceUnderLoss(double a) { return 1.0 + 8.0 / (std::pow(a, 4) + 16.0 * a * a + 6.0); }

// The first round looks at no more than about so many: it only has to come near.
constexpr int kCoarseFeatures = 200;
constexpr int kMaxRounds = 4;  // of gathering inliers and refining, until the inliers stay

// PoseResiduals as Ceres' solver of small dense problems wants them.
template <int kParameters>
struct TinyFunction {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kParameters };

  const PoseResiduals& residuals;

  int NumResiduals() const { return residuals.count(); }
  bool operator()(const double* parameters, double* values, double* jacobian) const {
    residuals.Evaluate(parameters, values, jacobian);
    return true;
  }
};

Eigen::Vector3d SomeLandmark(const PoseProblem& problem) {
  if (!problem.points.empty()) return problem.points.front().position_in_map;
  if (!problem.lines.empty()) return problem.lines.front().segment_in_map.start;
  return Eigen::Vector3d::Zero();
}

// Keeps every `step`-th flagged feature, so that what is left is evenly spread.
void ThinOut(std::size_t step, std::vector<std::uint8_t>* flags) {
  std::size_t seen = 0;
  for (std::uint8_t& flag : *flags) {
    if (flag != 0 && seen++ % step != 0) flag = 0;
  }
}

std::size_t CountOf(const std::vector<std::uint8_t>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
}

InlierFlags Thinned(InlierFlags inliers, int count) {
  const std::size_t step = static_cast<std::size_t>((inliers.count + count - 1) / count);
  ThinOut(step, &inliers.points);
  ThinOut(step, &inliers.lines);
  inliers.count = static_cast<int>(CountOf(inliers.points) + CountOf(inliers.lines));
  return inliers;
}

// The stated pixel noise is worth so many coordinates of residuals: ten features. A query of a
// handful of inliers is judged by what is usual, one of a hundred by its own residuals.
constexpr double kPriorCoordinates = 20.0;
constexpr double kFreedom = 6.0;  // of the pose, which explains as many coordinates by itself

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
    for (int round = 0; round < kMaxRounds; ++round) {
      const bool coarse = round == 0 && inliers.count > kCoarseFeatures;
      if (inliers.count < MinFeatures(mode_)) break;
      if (!Solve(coarse ? Thinned(inliers, kCoarseFeatures) : inliers, &pose)) break;
      refined.converged = true;
      InlierFlags next = Inliers(pose);
      const bool stays = !coarse && next.points == inliers.points && next.lines == inliers.lines;
      inliers = std::move(next);
      if (stays) break;
    }
    // The last round may have left too few to determine what it has found.
    refined.converged = refined.converged && inliers.count >= MinFeatures(mode_);
    refined.camera_from_map = pose;
    const ResidualSum residuals = SumResiduals(problem_, PoseMatrix(pose), inliers);
    refined.inlier_rms_px = residuals.Rms() * problem_.focal_length_px;
    const double sigma = FeatureSigma(residuals, inliers.count);
    refined.feature_sigma_px = sigma * problem_.focal_length_px;
    refined.covariance = Covariance(pose, inliers, sigma);
    refined.point_inliers = std::move(inliers.points);
    refined.line_inliers = std::move(inliers.lines);
    return refined;
  }

 private:
  InlierFlags Inliers(const Rigid3& pose) const {
    return FindInliers(problem_, pose, options_.max_reprojection_error_px);
  }

  bool Solve(const InlierFlags& inliers, Rigid3* pose) const {
    if (mode_ == Refinement::k4Dof) {
      return Solve<1>(inliers, YawChart(pose->rotation, problem_.gravity_in_camera), pose);
    }
    return Solve<3>(inliers, FreeChart(pose->rotation), pose);
  }

  template <int kTurns>
  bool Solve(const InlierFlags& inliers, const RotationChart& chart, Rigid3* pose) const {
    const PoseResiduals residuals(problem_, inliers, chart, Scales());
    ceres::TinySolver<TinyFunction<kTurns + 3>> solver;
    solver.options.max_num_iterations = kMaxSolverIterations;
    solver.options.function_tolerance = kFunctionTolerance * residuals.count();
    solver.options.parameter_tolerance = kParameterTolerance;
    solver.options.initial_trust_region_radius = kTrustRegionRadius;
    Eigen::Matrix<double, kTurns + 3, 1> parameters = Eigen::Matrix<double, kTurns + 3, 1>::Zero();
    parameters.template tail<3>() = pose->translation;
    const auto summary = solver.Solve({residuals}, &parameters);
    if (!parameters.allFinite() || !std::isfinite(summary.final_cost)) return false;
    pose->rotation = Eigen::Quaterniond(chart.Rotation(parameters.data())).normalized();
    pose->translation = parameters.template tail<3>();
    return true;
  }

  ResidualScales Scales() const {
    ResidualScales scales{.feature_sigma = sigma_, .loss_scale = LossScale()};
    if (mode_ == Refinement::kAuto) {
      scales.gravity_sigma_rad = std::max(problem_.gravity_sigma_rad, kMinGravitySigmaRad);
    }
    return scales;
  }

  // Where gravity is held, its error shows in the residuals of good matches, in sigmas of a pixel.
  double LossScale() const {
    const double from_gravity =
        mode_ == Refinement::k4Dof ? problem_.gravity_sigma_rad / sigma_ : 0.0;
    return kLossScaleSigmas * std::hypot(1.0, from_gravity);
  }

  // Of a coordinate, plane z = 1. An error that n features share moves the pose as if each of their
  // 2 n coordinates had n / 3 times its variance: (J^T J)^-1 then moves their images by that
  // variance in the mean, its 6 degrees of freedom being shared out over 2 n coordinates.
  double FeatureSigma(const ResidualSum& residuals, int features) const {
    // Where gravity is held its error is in the residuals, and in the covariance by itself already.
    const bool held = mode_ == Refinement::k4Dof;
    const double squares = held ? 0.0 : residuals.squares;
    const double coordinates = held ? 0.0 : std::max(0.0, residuals.coordinates - kFreedom);
    const double noise2 =
        (kPriorCoordinates * sigma_ * sigma_ + squares) / (kPriorCoordinates + coordinates);
    const double shared = problem_.shared_error_rad;
    return std::sqrt(noise2 + features / 3.0 * shared * shared);
  }

  PoseCovariance Covariance(const Rigid3& pose, const InlierFlags& inliers, double sigma) const {
    const PoseMatrix matrix(pose);
    const Eigen::Matrix<double, 6, 6> information = PoseInformation(
        problem_, matrix, inliers, std::sqrt(VarianceUnderLoss(LossScale())) * sigma);
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

std::size_t RefinedPose::InlierCount() const {
  return CountOf(point_inliers) + CountOf(line_inliers);
}

RefinedPose RefinePose(const PoseProblem& problem, const Rigid3& camera_from_map,
                       const RefineOptions& options) {
  // About a landmark: far from the map's origin rotation and translation could not be told apart in
  // double precision.
  const Eigen::Vector3d origin = SomeLandmark(problem);
  const PoseProblem moved = MovedTo(problem, origin);
  const Rigid3 start = {camera_from_map.rotation, camera_from_map * origin};
  RefinedPose refined = Refiner(moved, options).Run(start);
  Rigid3& pose = refined.camera_from_map;
  pose.translation -= pose.rotation * origin;
  return refined;
}

}  // namespace maploc
