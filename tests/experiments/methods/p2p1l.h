// Pose from two points and one line, gravity unused: a baseline.
//
// Problem: two map points P1, P2 seen along rays x1, x2, and a map line through L with direction D
// of which the plane n through the camera's centre is seen. Equations:
//   l_i x_i = R P_i + t,  l_i > 0;   n . R D = 0;   n . (R L + t) = 0.
// Unknown first: N = R^T n, the seen plane's normal in the map. It is perpendicular to D, so with
// U, V spanning what is perpendicular to D, N = cos U + sin V; and n times the first equation gives
//   l_i = N . (P_i - L) / (n . x_i),
// linear in (cos, sin). The distance |l1 x1 - l2 x2|^2 = |P1 - P2|^2 (cos^2 + sin^2) is then one
// homogeneous quadratic in (cos, sin). The sign of N makes the depths positive; R turns N to n and
// P2 - P1 to l2 x2 - l1 x1; t = l1 x1 - R P1.
// Frames: rays and normal in the camera, P, L, D in the map; out: camera_from_map.
// Preconditions: finite input; rays, normal and direction of any length but zero.
// Solutions: at most two. (The literature's count of four holds those of negative depth.) Whether
// the line is in front is for the caller to see.
// Degenerate: equal rays or points; a point on the image line (n . x_i = 0); the two points one
// above the other over the seen plane (P2 - P1 along N); both points on the map line. The line may
// meet the pair's line or run along it (features of one wall): that is not degenerate.
// Source: own derivation; the problem is of Ramalingam, Bouaziz, Sturm, "Pose estimation using both
// points and lines for geo-localization", ICRA 2011.
#pragma once

#include <Eigen/Core>

#include "mapstore/geometry/rigid3.h"

namespace maploc {

// Returns the number of poses written, 0 to 2. (The room for eight lets a caller share its array
// with any minimal solver.)
int SolveP2p1l(const Eigen::Vector3d rays[2], const Eigen::Vector3d points[2],
               const Eigen::Vector3d& plane_normal, const Eigen::Vector3d& line_point,
               const Eigen::Vector3d& line_direction, Rigid3 camera_from_map[8]);

}  // namespace maploc
