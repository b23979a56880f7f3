// Upright pose from one point and one line (the paper's 1P1L, section III-A).
//
// Problem: a map point P seen along ray x, and a map line through L with direction D of which the
// plane n through the camera's centre is seen (n = cross product of any two rays of the image
// line); gravity known.
// Equations: l x = Rz(yaw) P + t,  l > 0;   n . Rz(yaw) D = 0;   n . (Rz(yaw) L + t) = 0.
// The second is yaw_equation.h; then l = n . Rz (P - L) / (n . x),  t = l x - Rz P.
// Frames: ray and normal in the gravity-aligned camera frame, P, L, D in the map (z up); out:
// aligned_from_map.
// Preconditions: finite input; ray, normal and direction of any length.
// Solutions: at most two, each with the point's depth positive. Whether the line is in front is for
// the caller to see (a line has no visible end points of its own).
// Degenerate: a vertical line (A = B = 0) or a horizontal one at the camera's height, in general
// w = 0; the point's ray in the line's plane (n . x = 0: the image point on the image line), which
// is wider than the paper's "the point lies on the line".
// Source: the paper's equations (2)-(5) without the frames C1 and W1; the same road as PoseLib's
// up1p1ll. The paper's own road is a test reference (tests/unit/server/solvers).
#pragma once

#include <Eigen/Core>

#include "server/solvers/aligned.h"

namespace maploc {

// Kernel. Returns the number of poses, 0 to 2; entries from there on are overwritten with nothing
// of use.
int SolveUp1p1l(const Eigen::Vector3d& ray, const Eigen::Vector3d& point,
                const Eigen::Vector3d& plane_normal, const Eigen::Vector3d& line_point,
                const Eigen::Vector3d& line_direction, AlignedPose aligned_from_map[2]);

}  // namespace maploc
