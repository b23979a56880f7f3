#include "server/ransac/local_optimizer.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "mapstore/geometry/gravity.h"

namespace maploc {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// A stated gravity sigma of zero is still a measurement: 0.01 degrees keeps the equations regular
// and turns the optimization into one of 4 degrees of freedom.
constexpr double kMinGravitySigmaRad = 1.7e-4;
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

// Cheap looks before the derivatives: most features are outliers.
bool IsPointNear(const PoseMatrix& pose, const PointCorrespondence& point, double threshold2) {
  const Eigen::Vector3d q = pose.rotation * point.position_in_map + pose.translation;
  const Eigen::Vector2d error_times_depth = q.head<2>() - q.z() * point.normalized;
  return q.z() > 0 && error_times_depth.squaredNorm() < threshold2 * q.z() * q.z();
}

bool IsLineNear(const PoseMatrix& pose, const LineCorrespondence& line, double threshold2) {
  const Eigen::Vector3d start = pose.rotation * line.segment_in_map.start + pose.translation;
  const Eigen::Vector3d along =
      pose.rotation * (line.segment_in_map.end - line.segment_in_map.start);
  const Eigen::Vector3d moment = start.cross(along);
  const double e0 = moment.head<2>().dot(line.normalized.start) + moment.z();
  const double e1 = moment.head<2>().dot(line.normalized.end) + moment.z();
  return std::max(e0 * e0, e1 * e1) < threshold2 * moment.head<2>().squaredNorm();
}

void AddFeatures(const PoseProblem& problem, double threshold, const PoseMatrix& pose,
                 NormalEquations* equations) {
  const double threshold2 = threshold * threshold;
  const double min_length = kMinProjectedLinePx / problem.focal_length_px;
  Eigen::Vector2d error;
  Jacobian26 jacobian;
  for (const PointCorrespondence& point : problem.points) {
    if (!IsPointNear(pose, point, threshold2)) continue;
    if (!PointReprojection(pose, point, &error, &jacobian)) continue;
    equations->Add(error, jacobian, TukeyWeight(error.squaredNorm(), threshold2));
  }
  for (const LineCorrespondence& line : problem.lines) {
    if (!IsLineNear(pose, line, threshold2)) continue;
    if (!IsLineInlier(pose, line, threshold, min_length)) continue;
    LineReprojection(pose, line, &error, &jacobian);
    equations->Add(error, jacobian, TukeyWeight(0.5 * error.squaredNorm(), threshold2));
  }
}

// The pose's gravity g = R (0, 0, -1); its derivative by w is -[g]x. Along the measured direction
// nothing is measured, which the cross product with it leaves out.
void AddGravity(const PoseProblem& problem, double pixel_sigma, const PoseMatrix& pose,
                NormalEquations* equations) {
  const double sigma = std::max(problem.gravity_sigma_rad, kMinGravitySigmaRad);
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

bool OptimizationStep(const PoseProblem& centred, double threshold, bool use_gravity,
                      PoseMatrix* camera_from_centred) {
  NormalEquations equations;
  AddFeatures(centred, threshold, *camera_from_centred, &equations);
  const bool measured = use_gravity && centred.has_gravity;
  if (equations.features < (measured ? 2 : 3)) return false;
  if (measured) {
    AddGravity(centred, threshold / kSigmasOfThreshold, *camera_from_centred, &equations);
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
