// What the inliers and gravity leave uncertain.
#pragma once

#include <cmath>

#include "mapstore/model/localization.h"
#include "mapstore/model/matches.h"
#include "server/solvers/reprojection.h"

namespace maploc {

// Information matrix of (w, d), the left perturbation of reprojection.h: the sum of J^T J / sigma^2
// over the flagged features, `sigma` in the plane z = 1.
Eigen::Matrix<double, 6, 6> PoseInformation(const PoseProblem& problem,
                                            const PoseMatrix& camera_from_map,
                                            const InlierFlags& inliers, double sigma);

// Squared errors of the flagged features that project, plane z = 1: two coordinates each.
struct ResidualSum {
  double squares = 0.0;
  int coordinates = 0;

  double Rms() const { return coordinates > 0 ? std::sqrt(squares / coordinates) : 0.0; }
};
ResidualSum SumResiduals(const PoseProblem& problem, const PoseMatrix& camera_from_map,
                         const InlierFlags& inliers);

// Covariance of (w, d) when gravity is one more measurement of `gravity_sigma_rad`.
Eigen::Matrix<double, 6, 6> SoftGravityCovariance(const Eigen::Matrix<double, 6, 6>& information,
                                                  const Eigen::Vector3d& gravity_in_camera,
                                                  double gravity_sigma_rad);
// ... when gravity is held: yaw and translation from the features, and gravity's own error
// propagated into all six.
Eigen::Matrix<double, 6, 6> HeldGravityCovariance(const Eigen::Matrix<double, 6, 6>& information,
                                                  const Eigen::Vector3d& gravity_in_camera,
                                                  double gravity_sigma_rad);
// ... when gravity is forgotten.
Eigen::Matrix<double, 6, 6> FreeCovariance(const Eigen::Matrix<double, 6, 6>& information);

// From (w, d) of camera_from_map to map_from_camera in the order and frame of PoseCovariance:
// centre c = -R^T t moves by -R^T d - R^T [t]x w, its rotation vector in map axes by -R^T w.
PoseCovariance CovarianceOfMapFromCamera(const PoseMatrix& camera_from_map,
                                         const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace maploc
