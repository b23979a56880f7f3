#include "server/refinement/covariance.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "mapstore/geometry/gravity.h"
#include "server/refinement/pose_residuals.h"
#include "server/refinement/skew.h"

namespace maploc {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Directions that nothing determines get a huge variance instead of none: eigenvalues below this
// share of the largest count as this share.
constexpr double kMinRelativeInformation = 1e-14;

template <typename Matrix>
Matrix InverseOfInformation(const Matrix& information) {
  // Jacobi scaling first: rotations and translations have units of their own.
  const auto scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse().eval();
  const Matrix scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scaled);
  const auto floor = kMinRelativeInformation * std::max(eigen.eigenvalues().maxCoeff(), 1e-300);
  const auto inverse = eigen.eigenvalues().cwiseMax(floor).cwiseInverse().eval();
  return scale.asDiagonal() * eigen.eigenvectors() * inverse.asDiagonal() *
         eigen.eigenvectors().transpose() * scale.asDiagonal();
}

}  // namespace

Matrix6 PoseInformation(const PoseProblem& problem, const PoseMatrix& camera_from_map,
                        const InlierFlags& inliers, double sigma) {
  Matrix6 information = Matrix6::Zero();
  Eigen::Vector2d error;
  Jacobian26 jacobian;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (inliers.points[i] == 0) continue;
    if (!PointReprojection(camera_from_map, problem.points[i], &error, &jacobian)) continue;
    information.noalias() += jacobian.transpose() * jacobian;
  }
  for (std::size_t i = 0; i < problem.lines.size(); ++i) {
    if (inliers.lines[i] == 0) continue;
    if (!LineReprojection(camera_from_map, problem.lines[i], &error, &jacobian)) continue;
    information.noalias() += jacobian.transpose() * jacobian;
  }
  return information / (sigma * sigma);
}

ResidualSum SumResiduals(const PoseProblem& problem, const PoseMatrix& camera_from_map,
                         const InlierFlags& inliers) {
  ResidualSum sum;
  Eigen::Vector2d error;
  const auto add = [&](bool projects) {
    if (!projects) return;
    sum.squares += error.squaredNorm();
    sum.coordinates += 2;
  };
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (inliers.points[i] == 0) continue;
    add(PointReprojection(camera_from_map, problem.points[i], &error, nullptr));
  }
  for (std::size_t i = 0; i < problem.lines.size(); ++i) {
    if (inliers.lines[i] == 0) continue;
    add(LineReprojection(camera_from_map, problem.lines[i], &error, nullptr));
  }
  return sum;
}

Matrix6 SoftGravityCovariance(const Matrix6& information, const Eigen::Vector3d& gravity_in_camera,
                              double gravity_sigma_rad) {
  const double sigma = std::max(gravity_sigma_rad, kMinGravitySigmaRad);
  const Eigen::Matrix<double, 3, 2> axes = PerpendicularBasis(gravity_in_camera);
  Matrix6 with_gravity = information;
  with_gravity.topLeftCorner<3, 3>() += axes * axes.transpose() / (sigma * sigma);
  return InverseOfInformation(with_gravity);
}

Matrix6 HeldGravityCovariance(const Matrix6& information, const Eigen::Vector3d& gravity_in_camera,
                              double gravity_sigma_rad) {
  const double sigma = std::max(gravity_sigma_rad, kMinGravitySigmaRad);
  // Columns: what is estimated (yaw about gravity, translation) and what is held (two tilts).
  Eigen::Matrix<double, 6, 4> estimated = Eigen::Matrix<double, 6, 4>::Zero();
  estimated.block<3, 1>(0, 0) = gravity_in_camera;
  estimated.block<3, 3>(3, 1).setIdentity();
  Eigen::Matrix<double, 6, 2> held = Eigen::Matrix<double, 6, 2>::Zero();
  held.topRows<3>() = PerpendicularBasis(gravity_in_camera);
  const Eigen::Matrix4d own =
      InverseOfInformation(Eigen::Matrix4d(estimated.transpose() * information * estimated));
  // An error e of the held tilts moves the estimate by -own (E^T I H) e.
  const Eigen::Matrix<double, 6, 2> response =
      held - estimated * (own * (estimated.transpose() * information * held));
  return estimated * own * estimated.transpose() + sigma * sigma * response * response.transpose();
}

Matrix6 FreeCovariance(const Matrix6& information) { return InverseOfInformation(information); }

PoseCovariance CovarianceOfMapFromCamera(const PoseMatrix& camera_from_map,
                                         const Matrix6& covariance) {
  const Eigen::Matrix3d map_from_camera = camera_from_map.rotation.transpose();
  Matrix6 jacobian = Matrix6::Zero();  // rows: position, rotation; columns: w, d
  jacobian.topLeftCorner<3, 3>() = -map_from_camera * Skew(camera_from_map.translation);
  jacobian.topRightCorner<3, 3>() = -map_from_camera;
  jacobian.bottomLeftCorner<3, 3>() = -map_from_camera;
  const Matrix6 moved = jacobian * covariance * jacobian.transpose();
  // The product is symmetric up to rounding alone, and callers decompose it as symmetric.
  return 0.5 * (moved + moved.transpose());
}

}  // namespace maploc
