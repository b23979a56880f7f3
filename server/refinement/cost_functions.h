// Ceres cost functions with analytic Jacobians, whitened: residuals are in standard deviations.
//
// Parameters: one block turn[R], the pose's rotation as Exp(B turn) R0 with a fixed R0 and a fixed
// 3 x R basis B; one block translation[3].
//   * 6 degrees of freedom: R = 3, B the identity.
//   * 4 degrees of freedom: R = 1, B = gravity in the camera; R0 agrees with gravity exactly, and
//   so
//     does every Exp(B turn) R0.
// d Exp(w) v / dw = -[Exp(w) v]x Jl(w), Jl the left Jacobian of SO(3) (Sola, Deray, Atchuthan 2018,
// "A micro Lie theory", equation 145), so the Jacobians are exact at every turn.
#pragma once

#include <memory>

#include <ceres/ceres.h>

#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/matches.h"
#include "server/solvers/reprojection.h"

namespace maploc {

// How the parameter block `turn` becomes a rotation. Immutable; shared by all costs of a problem.
struct RotationChart {
  Eigen::Matrix3d base_rotation = Eigen::Matrix3d::Identity();  // R0, camera_from_map
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> basis;      // B

  int size() const { return static_cast<int>(basis.cols()); }
  Eigen::Matrix3d Rotation(const double* turn) const;
  // d w_left / d turn, 3 x R: the left perturbation of Rotation(turn) that a change of turn makes.
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> LeftJacobian(const double* turn) const;
};

// The chart of 6 degrees of freedom about a pose.
RotationChart FreeChart(const Eigen::Quaterniond& camera_from_map);
// The chart of yaw alone: base_rotation is the rotation nearest to `camera_from_map` that agrees
// with `gravity_in_camera` (unit).
RotationChart YawChart(const Eigen::Quaterniond& camera_from_map,
                       const Eigen::Vector3d& gravity_in_camera);

// Two residuals: the point's reprojection error over sigma (plane z = 1). Parameters: turn,
// translation. A point behind the camera makes Evaluate fail, so that Ceres shortens the step.
std::unique_ptr<ceres::CostFunction> MakePointCost(const RotationChart& chart,
                                                   const PointCorrespondence& point, double sigma);
// Two residuals: the end points' distances to the projected line over sigma.
std::unique_ptr<ceres::CostFunction> MakeLineCost(const RotationChart& chart,
                                                  const LineCorrespondence& line, double sigma);
// Two residuals: the pose's gravity against the measured one, about two axes perpendicular to it,
// over sigma (rad). Parameters: turn.
std::unique_ptr<ceres::CostFunction> MakeGravityCost(const RotationChart& chart,
                                                     const Eigen::Vector3d& gravity_in_camera,
                                                     double sigma_rad);

// Two unit vectors perpendicular to `direction` (unit) and to each other, as columns.
Eigen::Matrix<double, 3, 2> PerpendicularBasis(const Eigen::Vector3d& direction);

}  // namespace maploc
