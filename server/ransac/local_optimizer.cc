#include "server/ransac/local_optimizer.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Cholesky>

#include "mapstore/geometry/gravity.h"

namespace maploc {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// So many features of a kind place a pose far within the threshold; more only cost time. Refinement
// takes all. The scoring arrays are in random order: the first ones are a random sample.
constexpr std::size_t kMaxFeaturesOfKind = 64;
// The threshold is taken as three sigmas of a keypoint.
constexpr double kSigmasOfThreshold = 3.0;

struct NormalEquations {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  int features = 0;

  void Add(const Eigen::Vector2d& error, const Jacobian26& jacobian, double weight) {
    matrix.noalias() += weight * jacobian.transpose() * jacobian;
    right.noalias() -= weight * jacobian.transpose() * error;
    ++features;
  }
};

double TukeyWeight(double error2, double threshold2) {
  const double inside = 1.0 - error2 / threshold2;
  return inside > 0 ? inside * inside : 0.0;
}

bool Reproject(const PoseMatrix& pose, const PointCorrespondence& point, Eigen::Vector2d* error,
               Jacobian26* jacobian) {
  return PointReprojection(pose, point, error, jacobian);
}

bool Reproject(const PoseMatrix& pose, const LineCorrespondence& line, Eigen::Vector2d* error,
               Jacobian26* jacobian) {
  return LineReprojection(pose, line, error, jacobian);
}

// What scoring squares: a point's distance, the mean over a line's two end points.
double ScoredError2(const PointCorrespondence&, const Eigen::Vector2d& error) {
  return error.squaredNorm();
}

double ScoredError2(const LineCorrespondence&, const Eigen::Vector2d& error) {
  return 0.5 * error.squaredNorm();
}

// `near`: the places of the features that score within `threshold`.
template <typename Correspondence>
void AddNear(const std::vector<Correspondence>& features, const Places& places,
             std::span<const std::uint32_t> near, double threshold, const PoseMatrix& pose,
             NormalEquations* equations) {
  Eigen::Vector2d error;
  Jacobian26 jacobian;
  for (const std::uint32_t place : near.first(std::min(near.size(), kMaxFeaturesOfKind))) {
    const Correspondence& feature = features[places.feature_at[place]];
    if (!Reproject(pose, feature, &error, &jacobian)) continue;
    equations->Add(error, jacobian,
                   TukeyWeight(ScoredError2(feature, error), threshold * threshold));
  }
}

// The pose's gravity g = R (0, 0, -1); its derivative by w is -[g]x. Along the measured direction
// nothing is measured, which the cross product with it leaves out.
void AddGravity(const PoseProblem& problem, double pixel_sigma, const PoseMatrix& pose,
                NormalEquations* equations) {
  const double sigma = std::max(problem.gravity_sigma_rad, kMinGravitySigmaRad);
  // Features weigh 1 instead of 1 / pixel_sigma^2: so gravity weighs pixel_sigma^2 times as much.
  const double weight = pixel_sigma * pixel_sigma / (sigma * sigma);
  const Eigen::Vector3d& measured = problem.gravity_in_camera;
  const Eigen::Vector3d predicted = -pose.rotation.col(2);
  const Eigen::Vector3d error = measured.cross(predicted);
  // d(m x (g + w x g))/dw = (m . g) I - g m^T.
  const Eigen::Matrix3d jacobian =
      measured.dot(predicted) * Eigen::Matrix3d::Identity() - predicted * measured.transpose();
  equations->matrix.topLeftCorner<3, 3>() += weight * jacobian.transpose() * jacobian;
  equations->right.head<3>() -= weight * jacobian.transpose() * error;
}

Eigen::Matrix3d Exp(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

}  // namespace

LocalOptimizer::LocalOptimizer(const PreparedProblem& prepared, bool use_gravity)
    : prepared_(prepared), use_gravity_(use_gravity && prepared.centred.has_gravity) {}

bool LocalOptimizer::Step(double threshold, PoseMatrix* camera_from_centred) {
  const ScoringOptions near = {.threshold = static_cast<float>(threshold),
                               .min_line_length = static_cast<float>(
                                   kMinProjectedLinePx / prepared_.centred.focal_length_px)};
  NormalEquations equations;
  // What lies near is found in single precision, all features at a time; most are outliers.
  const PoseMatrix& pose = *camera_from_centred;
  const ScoringPose scoring_pose = ToScoringPose(pose);
  std::size_t count = FindScoringPoints(prepared_.point_arrays, scoring_pose, near, &places_);
  AddNear(prepared_.centred.points, prepared_.point_places, {places_.data(), count}, threshold,
          pose, &equations);
  count = FindScoringLines(prepared_.line_arrays, scoring_pose, near, &places_);
  AddNear(prepared_.centred.lines, prepared_.line_places, {places_.data(), count}, threshold, pose,
          &equations);
  // Six unknowns. A feature gives two equations, and so does gravity.
  if (equations.features < (use_gravity_ ? 2 : 3)) return false;
  if (use_gravity_) {
    AddGravity(prepared_.centred, threshold / kSigmasOfThreshold, pose, &equations);
  }
  // Relative damping: harmless where the equations are regular.
  equations.matrix.diagonal() *= 1.0 + 1e-6;
  const Eigen::LDLT<Matrix6> factors(equations.matrix);
  if (factors.info() != Eigen::Success || !factors.isPositive()) return false;
  const Vector6 step = factors.solve(equations.right);
  if (!step.allFinite()) return false;
  camera_from_centred->rotation = Exp(step.head<3>()) * camera_from_centred->rotation;
  camera_from_centred->translation += step.tail<3>();
  return true;
}

}  // namespace maploc
