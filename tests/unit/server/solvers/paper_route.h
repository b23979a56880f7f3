// The paper's own derivation, as it stands there: intermediate frames C1 and W1, yaw by
// trigonometry. A reference for the solvers, slow and plain. Every pose of positive depth is
// returned.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mapstore/geometry/rigid3.h"

namespace maploc::testing {

// Section III-A, equations (2)-(5). Rays in the camera, points in the map.
std::vector<Rigid3> PaperOnePointOneLine(const Eigen::Vector3d& gravity_in_camera,
                                         const Eigen::Vector3d& ray1, const Eigen::Vector3d& point1,
                                         const Eigen::Vector3d& ray2, const Eigen::Vector3d& ray3,
                                         const Eigen::Vector3d& line2,
                                         const Eigen::Vector3d& line3);

// Section III-B, equations (6)-(9). Rays with z = 1.
std::vector<Rigid3> PaperTwoPoints(const Eigen::Vector3d& gravity_in_camera,
                                   const Eigen::Vector3d& ray1, const Eigen::Vector3d& point1,
                                   const Eigen::Vector3d& ray2, const Eigen::Vector3d& point2);

}  // namespace maploc::testing
