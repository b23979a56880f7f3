#include "client/odometry/uncertain_pose.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace maploc {
namespace {

constexpr double kUnitTolerance = 1e-6;      // of the norm: normalized in single precision
constexpr double kLargestMeters = 1e9;       // beyond it a double has no millimetres
constexpr double kLargestVariance = 1e12;    // beyond it a sum with what odometry adds is not exact
constexpr double kSymmetryTolerance = 1e-6;  // relative: numbers that were printed and read again
constexpr double kRoundingVariance = 1e-12;  // relative: a singular covariance is one too

Eigen::Vector3d RotationVector(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;  // the shorter way round
  const double sine = rotation.vec().norm();
  const double angle = 2.0 * std::atan2(sine, sign * rotation.w());
  // angle / sine tends to 2; with a smaller sine the quotient would only lose digits.
  return sine < 1e-12 ? Eigen::Vector3d(2.0 * sign * rotation.vec())
                      : Eigen::Vector3d(angle / sine * sign * rotation.vec());
}

}  // namespace

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

UncertainPose Moved(const UncertainPose& map_from_a, const Rigid3& a_from_b) {
  PoseCovariance jacobian = PoseCovariance::Identity();
  jacobian.topRightCorner<3, 3>() =
      -CrossMatrix(map_from_a.map_from_body.rotation * a_from_b.translation);
  return {map_from_a.map_from_body * a_from_b,
          jacobian * map_from_a.covariance * jacobian.transpose()};
}

UncertainPose MapFromOdom(const UncertainPose& map_from_base, const Rigid3& odom_from_base) {
  return Moved(map_from_base, odom_from_base.Inverse());
}

PoseVector Difference(const Rigid3& to, const Rigid3& from) {
  PoseVector difference;
  difference << to.translation - from.translation,
      RotationVector(to.rotation * from.rotation.conjugate());
  return difference;
}

Rigid3 Plus(const Rigid3& pose, const PoseVector& difference) {
  const Eigen::Vector3d turn = difference.tail<3>();
  const double angle = turn.norm();
  // Without an angle the axis is zero, and the turn the identity.
  const Eigen::Vector3d axis = angle > 0.0 ? Eigen::Vector3d(turn / angle) : turn;
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(angle, axis));
  return {(turned * pose.rotation).normalized(), pose.translation + difference.head<3>()};
}

Status CheckPose(std::string_view field, const Rigid3& pose) {
  if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) {
    return InvalidArgument(field, "must be finite", "NOT_FINITE");
  }
  if (pose.translation.cwiseAbs().maxCoeff() > kLargestMeters) {
    return InvalidArgument(field, "its position must be within 1e9 of the origin", "OUT_OF_RANGE");
  }
  if (std::abs(pose.rotation.norm() - 1.0) > kUnitTolerance) {
    return InvalidArgument(field, "its quaternion must have the norm 1; normalize it",
                           "NOT_A_ROTATION");
  }
  return Status::Ok();
}

Status CheckCovariance(std::string_view field, const PoseCovariance& covariance) {
  if (!covariance.allFinite()) return InvalidArgument(field, "must be finite", "NOT_FINITE");
  const PoseVector variances = covariance.diagonal();
  if (variances.minCoeff() < 0.0 || variances.maxCoeff() > kLargestVariance) {
    return InvalidArgument(field, "its variances must be in 0 to 1e12", "NOT_A_COVARIANCE");
  }
  // Correlations: so that metres do not hide what is wrong with radians.
  const PoseVector scale =
      variances.unaryExpr([](double v) { return v > 0.0 ? 1.0 / std::sqrt(v) : 1.0; });
  const PoseCovariance correlations = scale.asDiagonal() * covariance * scale.asDiagonal();
  if ((correlations - correlations.transpose()).cwiseAbs().maxCoeff() > kSymmetryTolerance) {
    return InvalidArgument(field, "must be symmetric", "NOT_A_COVARIANCE");
  }
  const PoseCovariance rounded = correlations + kRoundingVariance * PoseCovariance::Identity();
  if (variances.maxCoeff() == 0.0 || rounded.llt().info() != Eigen::Success) {
    return InvalidArgument(field, "must be positive semidefinite and not zero; send the answer's",
                           "NOT_A_COVARIANCE");
  }
  return Status::Ok();
}

}  // namespace maploc
