// Pose from three points, gravity unused: for queries whose gravity is absent or wrong, and as a
// baseline.
//
// Problem: l_i y_i = R P_i + t, i = 1, 2, 3, y_i unit rays, l_i > 0.
// Equation: the squared distances |l_i y_i - l_j y_j|^2 = |P_i - P_j|^2 are three quadrics in
// (l1, l2, l3); a pencil of two of them holds a degenerate quadric, a root of a cubic, that factors
// into two planes; each plane meets the quadrics in at most two points. The depths are polished by
// Gauss and Newton, then R from the two triangles.
// Frames: rays in the camera, points in the map; out: camera_from_map.
// Preconditions: finite input, rays of any length but zero.
// Solutions: at most four, all depths positive.
// Degenerate: points on a line, equal rays, the camera on the danger cylinder.
// Source: Persson and Nordberg, "Lambda Twist: an accurate fast robust perspective three point
// (P3P) solver", ECCV 2018, written anew. Deviation: up to ten steps of polishing, stopped by the
// residual.
#pragma once

#include <Eigen/Core>

#include "mapstore/geometry/rigid3.h"

namespace maploc {

// Returns the number of poses written, 0 to 4.
int SolveP3p(const Eigen::Vector3d rays[3], const Eigen::Vector3d points[3],
             Rigid3 camera_from_map[4]);

// Conditioning: the sines of the triangle's smallest angle in the map and of the smallest angle
// between two rays multiplied; 0 when degenerate.
double P3pConditioning(const Eigen::Vector3d rays[3], const Eigen::Vector3d points[3]);

}  // namespace maploc
