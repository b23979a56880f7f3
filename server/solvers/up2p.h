// Upright two-point pose (the paper's 2P, section III-B).
//
// Problem: two map points P1, P2 seen along rays x1, x2, gravity known. With x_i in the aligned
// frame:  l_i x_i = Rz(yaw) P_i + t,  l_i > 0.
// Equation: eliminating t and the depths l_i gives n . Rz(yaw) D = 0 with n = x1 x x2, D = P2 - P1
// (yaw_equation.h): 1P1L on the virtual line through the two points. Then
//   l1 = -(Rz D x x2) . n / |n|^2,   t = l1 x1 - Rz P1,   l2 = -(Rz D x x1) . n / |n|^2.
// Frames: rays in the gravity-aligned camera frame, points in the map (z up); out:
// aligned_from_map. Preconditions: finite input; rays of any length, l_i is in units of the ray
// (with z = 1 in the camera it is the depth). Solutions: at most two, each with both depths
// positive. Degenerate: equal rays (n = 0); equal points; points one above the other and pairs on
// the horizon (w = 0). Pairs of equal height (C = 0) are not degenerate: yaw and yaw + 180 degrees,
// of which the depths keep one. Source: the paper's equations (6)-(9) after one elimination; the
// same constraint as Kukelova, Bujnak, Pajdla, "Closed-form solutions to minimal absolute pose
// problems with known vertical direction", ACCV 2010. Deviation: yaw as (cos, sin) from one
// quadratic, so that no yaw (theirs: 180 degrees) is special.
#pragma once

#include <Eigen/Core>

#include "server/solvers/aligned.h"

namespace maploc {

// Kernel. Returns the number of poses, 0 to 2; entries from there on are overwritten with nothing
// of use.
int SolveUp2p(const Eigen::Vector3d& ray1, const Eigen::Vector3d& point1,
              const Eigen::Vector3d& ray2, const Eigen::Vector3d& point2,
              AlignedPose aligned_from_map[2]);

}  // namespace maploc
