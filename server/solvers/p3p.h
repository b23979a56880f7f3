// Pose from three points, gravity unused: for queries whose gravity is absent or wrong, and as a
// baseline.
//
// Problem: l_i y_i = R P_i + t, i = 1, 2, 3, y_i unit rays, l_i > 0.
// Equation: the squared distances |l_i y_i - l_j y_j|^2 = |P_i - P_j|^2 are three quadrics in
// (l1, l2, l3). Two combinations of them without a constant term span a pencil, which holds a
// quadric of rank two: a root of a cubic (cubic.h). That one is a pair of planes, told by its
// adjugate; each plane meets another quadric of the pencil in at most two directions. Then scale,
// one step of Newton on the distances (more near the danger cylinder), and R from the two
// triangles. Frames: rays in the camera, points in the map; out: camera_from_map. Preconditions:
// finite input, rays of any length but zero. Solutions: at most four, all depths positive. A double
// root may come twice. Degenerate: points on a line, equal rays, the camera on the danger cylinder
// or in the points' plane. Source: the pencil is of Persson and Nordberg, "Lambda Twist: an
// accurate fast robust perspective three point (P3P) solver", ECCV 2018; the planes from the
// adjugate as in Ding, Yang, Larsson, Olsson, Astrom, "Revisiting the P3P problem", CVPR 2023;
// written anew. Deviations: cosines as one minus the half squared distance of the rays, exact for
// rays that are close; each plane is parametrized from the line where both meet, so that no
// coordinate is special.
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
