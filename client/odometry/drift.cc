#include "client/odometry/drift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace maploc {
namespace {

PoseVector Variances(const PoseSigmas& sigmas) {
  PoseVector vector;
  vector << sigmas.horizontal_m, sigmas.horizontal_m, sigmas.vertical_m, sigmas.tilt_rad,
      sigmas.tilt_rad, sigmas.yaw_rad;
  return vector.cwiseAbs2();
}

double Growth(double way) { return way * std::max(way, 1.0); }

Status CheckSigmas(const std::string& field, const PoseSigmas& sigmas, bool may_be_zero) {
  for (const double sigma :
       {sigmas.horizontal_m, sigmas.vertical_m, sigmas.tilt_rad, sigmas.yaw_rad}) {
    const double variance = sigma * sigma;  // may overflow, or vanish
    if (!std::isfinite(variance) || sigma < 0.0 || (variance == 0.0 && !may_be_zero)) {
      return InvalidArgument(
          field, may_be_zero ? "must be finite and not negative" : "must be finite and positive");
    }
  }
  return Status::Ok();
}

}  // namespace

Status CheckDrift(const OdometryDrift& drift) {
  // At rest none may be zero, because Track divides by a sum of covariances that must be positive
  // definite.
  MAPLOC_RETURN_IF_ERROR(CheckSigmas("drift.at_rest", drift.at_rest, false));
  MAPLOC_RETURN_IF_ERROR(CheckSigmas("drift.per_meter", drift.per_meter, true));
  return CheckSigmas("drift.per_radian", drift.per_radian, true);
}

PoseCovariance DriftCovariance(const OdometryDrift& drift, const Way& way,
                               const Eigen::Vector3d& travel_in_map) {
  const PoseVector variances = Growth(way.meters) * Variances(drift.per_meter) +
                               Growth(way.radians) * Variances(drift.per_radian);
  // An error e of the rotation that came half way moves the end by e x travel / 2.
  PoseCovariance jacobian = PoseCovariance::Identity();
  jacobian.topRightCorner<3, 3>() = -CrossMatrix(travel_in_map / 2.0);
  return jacobian * variances.asDiagonal() * jacobian.transpose();
}

PoseCovariance AtRestCovariance(const OdometryDrift& drift) {
  return Variances(drift.at_rest).asDiagonal();
}

}  // namespace maploc
