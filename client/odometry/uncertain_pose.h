// A pose in the map with its covariance, as the server answers it: the error of the position in the
// map's axes (map unit), and the small rotation about the map's fixed axes that takes the stated
// rotation to the true one (radians). So true_rotation = exp(error) * rotation.
#pragma once

#include <Eigen/Core>

#include "mapstore/base/status.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/localization.h"

namespace maploc {

using PoseVector = Eigen::Matrix<double, 6, 1>;  // x, y, z, rotX, rotY, rotZ, as PoseCovariance

struct UncertainPose {
  Rigid3 map_from_body;
  PoseCovariance covariance = PoseCovariance::Zero();
};

// The pose of a frame b whose pose in a is exact: with v = the way from a to b in the map's axes an
// error of a's rotation moves b by error x v, so the Jacobian is [I, -[v]x; 0, I].
UncertainPose Moved(const UncertainPose& map_from_a, const Rigid3& a_from_b);

// REP-105's transform from odom to map: where the odometry's origin lies, given the robot's pose in
// the map and, at the same moment, in the odometry's frame.
UncertainPose MapFromOdom(const UncertainPose& map_from_base, const Rigid3& odom_from_base);

// What takes `from` to `to`, in the order and the axes of PoseCovariance.
PoseVector Difference(const Rigid3& to, const Rigid3& from);
// The inverse: Difference(Plus(pose, d), pose) = d for rotations below pi.
Rigid3 Plus(const Rigid3& pose, const PoseVector& difference);

// [v]x: CrossMatrix(v) * w = v x w.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v);

// INVALID_ARGUMENT with the field's name: not finite, too far away, or no unit quaternion.
Status CheckPose(std::string_view field, const Rigid3& pose);
// INVALID_ARGUMENT with the field's name: not finite, too large, not symmetric, a negative
// variance.
Status CheckCovariance(std::string_view field, const PoseCovariance& covariance);

}  // namespace maploc
