// From the camera's pose, which is estimated, to the body's, which is answered.
#pragma once

#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/localization.h"

namespace maploc {

inline Rigid3 MapFromBody(const Rigid3& camera_from_map, const Rigid3& camera_from_body) {
  return camera_from_map.Inverse() * camera_from_body;
}

// Moves a covariance of map_from_camera to map_from_body. With v = the way from camera to body in
// the map's axes, p_body = p_camera + v and d(v) = dtheta x v, so the Jacobian is [I, -[v]x; 0, I].
PoseCovariance BodyCovariance(const PoseCovariance& camera_covariance,
                              const Rigid3& camera_from_map, const Rigid3& camera_from_body);

}  // namespace maploc
