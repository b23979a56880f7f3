// Upright pose from one point and two VERTICAL lines (beyond the paper).
//
// A vertical line says nothing about yaw with a point, but two of them with a point do: in plan
// they are three bearings to three known positions. Problem: a map point P seen along ray x; two
// vertical map lines through L1, L2, seen as planes with normals n1, n2 through the camera's
// centre; gravity known. Equations: n_i . (Rz(yaw) (L_i - P) + l x) = 0, i = 1, 2. Eliminating the
// depth l:
//   (n2.x) n1 . Rz (L1 - P) - (n1.x) n2 . Rz (L2 - P) = 0,  again A cos + B sin + C = 0;
// then l by least squares from both, t = l x - Rz P.
// Frames: ray and normals in the gravity-aligned camera frame, P, L_i in the map (z up); out:
// aligned_from_map.
// Preconditions: finite input. The lines should be vertical: a tilt is an error of the model. The
// normals need not be horizontal; their noise along z is carried.
// Solutions: at most two with positive depth; for exactly vertical lines C = 0, the two differ by
// 180 degrees and one depth is negative: one solution.
// Degenerate: the camera on the danger circle through the plan positions of P, L1, L2 (A = B = C =
// 0); equal image lines; the point on an image line of both.
// Source: own derivation (plan resection, Snellius and Pothenot).
#pragma once

#include <Eigen/Core>

#include "server/solvers/aligned.h"

namespace maploc {

// Kernel. Returns the number of poses, 0 to 2; entries from there on are overwritten with nothing
// of use.
int SolveUp1p2v(const Eigen::Vector3d& ray, const Eigen::Vector3d& point,
                const Eigen::Vector3d& plane_normal1, const Eigen::Vector3d& line_point1,
                const Eigen::Vector3d& plane_normal2, const Eigen::Vector3d& line_point2,
                AlignedPose aligned_from_map[2]);

// sqrt(A^2 + B^2) over the sum of the norms of its two terms, in [0, 1]: 0 on the danger circle.
double Up1p2vConditioning(const Eigen::Vector3d& ray, const Eigen::Vector3d& point,
                          const Eigen::Vector3d& plane_normal1, const Eigen::Vector3d& line_point1,
                          const Eigen::Vector3d& plane_normal2, const Eigen::Vector3d& line_point2);

}  // namespace maploc
