// The residuals that refinement minimizes, in standard deviations, with analytic Jacobians.
//
// Parameters: turn[R], the pose's rotation as Exp(B turn) R0 with a fixed R0 and a fixed 3 x R
// basis B; then translation[3].
//   * 6 degrees of freedom: R = 3, B the identity.
//   * 4 degrees of freedom: R = 1, B = gravity in the camera; R0 agrees with gravity exactly, and
//     so does every Exp(B turn) R0.
// d Exp(w) v / dw = -[Exp(w) v]x Jl(w), Jl the left Jacobian of SO(3) (Sola, Deray, Atchuthan 2018,
// "A micro Lie theory", equation 145), so the Jacobians are exact at every turn.
//
// Robust: a feature's error e (in sigmas) enters as f = e sqrt(rho(s) / s), s = |e|^2, so that
// |f|^2 = rho(s) = a^2 log(1 + s / a^2), Cauchy's loss, and plain least squares minimizes it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/matches.h"
#include "server/solvers/reprojection.h"

namespace maploc {

// How the parameters `turn` become a rotation.
struct RotationChart {
  using Basis = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;

  Eigen::Matrix3d base_rotation = Eigen::Matrix3d::Identity();  // R0, camera_from_map
  Basis basis;                                                  // B

  int size() const { return static_cast<int>(basis.cols()); }
  Eigen::Matrix3d Rotation(const double* turn) const;
  // d w_left / d turn, 3 x R: the left perturbation of Rotation(turn) that a change of turn makes.
  Basis LeftJacobian(const double* turn) const;
};

// The chart of 6 degrees of freedom about a pose.
RotationChart FreeChart(const Eigen::Quaterniond& camera_from_map);
// The chart of yaw alone: base_rotation is the rotation nearest to `camera_from_map` that agrees
// with `gravity_in_camera` (unit).
RotationChart YawChart(const Eigen::Quaterniond& camera_from_map,
                       const Eigen::Vector3d& gravity_in_camera);

struct ResidualScales {
  double feature_sigma = 0.0;      // plane z = 1; positive
  double loss_scale = 2.5;         // a, in sigmas
  double gravity_sigma_rad = 0.0;  // 0: gravity is no measurement
};

// Two residuals a flagged feature: a point's reprojection error, the distances of a line's end
// points to its projection; last, two of gravity: the pose's against the measured one, about two
// axes perpendicular to it. A feature that does not project (behind the camera) gives a large
// constant, so that the step which led there is refused. Immutable.
class PoseResiduals {
 public:
  // `problem` must outlive this.
  PoseResiduals(const PoseProblem& problem, const InlierFlags& inliers, const RotationChart& chart,
                const ResidualScales& scales);

  int count() const { return count_; }
  // `parameters`: chart.size() + 3; `residuals`: count(); `jacobian`: count() x (chart.size() + 3),
  // column-major, may be null.
  void Evaluate(const double* parameters, double* residuals, double* jacobian) const;

 private:
  const PoseProblem& problem_;
  const RotationChart chart_;
  const ResidualScales scales_;
  std::vector<std::size_t> points_;
  std::vector<std::size_t> lines_;
  int count_ = 0;
};

// Two unit vectors perpendicular to `direction` (unit) and to each other, as columns.
Eigen::Matrix<double, 3, 2> PerpendicularBasis(const Eigen::Vector3d& direction);

}  // namespace maploc
