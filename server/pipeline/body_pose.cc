#include "server/pipeline/body_pose.h"

namespace maploc {

PoseCovariance BodyCovariance(const PoseCovariance& camera_covariance,
                              const Rigid3& camera_from_map, const Rigid3& camera_from_body) {
  const Eigen::Vector3d v = camera_from_map.rotation.conjugate() * camera_from_body.translation;
  Eigen::Matrix3d v_cross;
  v_cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  PoseCovariance jacobian = PoseCovariance::Identity();
  jacobian.topRightCorner<3, 3>() = -v_cross;
  return jacobian * camera_covariance * jacobian.transpose();
}

}  // namespace maploc
