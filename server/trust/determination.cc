#include "server/trust/determination.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "mapstore/base/median.h"
#include "server/refinement/covariance.h"
#include "server/solvers/reprojection.h"

namespace maploc {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kEnoughInliers = 400;
// The residuals of a pose that wrong matches have drawn along are smaller than its errors.
constexpr double kNoiseMargin = 1.5;
// Below this share of an observation nothing but itself determines what it measures.
constexpr double kLeastRedundancy = 1e-6;

// What the inliers measure, about an origin among them: far from the map's own origin rotation and
// translation could not be told apart in double precision.
class Measurements {
 public:
  Measurements(const PoseProblem& problem, const RefinedPose& pose)
      : origin_(SomeInlier(problem, pose)),
        pose_(Rigid3{pose.camera_from_map.rotation, pose.camera_from_map * origin_}) {
    const std::size_t step = Step(pose);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < problem.points.size(); ++i) {
      if (pose.point_inliers[i] != 0 && seen++ % step == 0) Add(problem.points[i]);
    }
    for (std::size_t i = 0; i < problem.lines.size(); ++i) {
      if (pose.line_inliers[i] != 0 && seen++ % step == 0) Add(problem.lines[i]);
    }
  }

  const PoseMatrix& pose() const { return pose_; }
  const std::vector<Jacobian26>& jacobians() const { return jacobians_; }

 private:
  // Every step-th inlier is looked at: their mean information counts, which more do not change.
  static std::size_t Step(const RefinedPose& pose) {
    return 1 + pose.InlierCount() / kEnoughInliers;
  }

  static Eigen::Vector3d SomeInlier(const PoseProblem& problem, const RefinedPose& pose) {
    for (std::size_t i = 0; i < problem.points.size(); ++i) {
      if (pose.point_inliers[i] != 0) return problem.points[i].position_in_map;
    }
    for (std::size_t i = 0; i < problem.lines.size(); ++i) {
      if (pose.line_inliers[i] != 0) return problem.lines[i].segment_in_map.start;
    }
    return Eigen::Vector3d::Zero();
  }

  void Add(PointCorrespondence point) {
    point.position_in_map -= origin_;
    Eigen::Vector2d error;
    Jacobian26 jacobian;
    if (!PointReprojection(pose_, point, &error, &jacobian)) return;
    jacobians_.push_back(jacobian);
  }

  void Add(LineCorrespondence line) {
    line.segment_in_map.start -= origin_;
    line.segment_in_map.end -= origin_;
    Eigen::Vector2d error;
    Jacobian26 jacobian;
    if (!LineReprojection(pose_, line, &error, &jacobian)) return;
    jacobians_.push_back(jacobian);
  }

  Eigen::Vector3d origin_;
  PoseMatrix pose_;
  std::vector<Jacobian26> jacobians_;
};

double LargestSigma(const Eigen::Matrix3d& covariance) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(eigen.eigenvalues().maxCoeff(), 0.0));
}

// The largest of the variances, as a share of those allowed. `covariance` of (w, d),
// reprojection.h.
double ShareOfLimit(const PoseMatrix& pose, const Matrix6& covariance, double rotation,
                    double position) {
  const PoseCovariance moved = CovarianceOfMapFromCamera(pose, covariance);
  if (!moved.allFinite()) return std::numeric_limits<double>::infinity();
  const double share = std::max(LargestSigma(moved.bottomRightCorner<3, 3>()) / rotation,
                                LargestSigma(moved.topLeftCorner<3, 3>()) / position);
  return share * share;
}

double InlierSigmaPx(const RefinedPose& pose, double max_reprojection_error_px) {
  return std::min(0.5 * max_reprojection_error_px, kNoiseMargin * pose.feature_sigma_px);
}

}  // namespace

double MedianInlierDepth(const PoseProblem& problem, const RefinedPose& pose) {
  const PoseMatrix matrix(pose.camera_from_map);
  std::vector<double> depths;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (pose.point_inliers[i] != 0) depths.push_back(SeenDepth(matrix, problem.points[i]));
  }
  for (std::size_t i = 0; i < problem.lines.size(); ++i) {
    if (pose.line_inliers[i] != 0) depths.push_back(SeenDepth(matrix, problem.lines[i]));
  }
  return depths.empty() ? 0.0 : UpperMedian(std::move(depths));
}

bool IsDetermined(const PoseProblem& problem, const RefinedPose& pose,
                  double max_reprojection_error_px, const PoseSpread& limit) {
  const Measurements measurements(problem, pose);
  const std::vector<Jacobian26>& jacobians = measurements.jacobians();
  if (jacobians.size() < 2) return false;
  const double sigma = InlierSigmaPx(pose, max_reprojection_error_px) / problem.focal_length_px *
                       std::sqrt(static_cast<double>(jacobians.size() - 1));
  Matrix6 information = Matrix6::Zero();
  for (const Jacobian26& jacobian : jacobians) {
    information.noalias() += jacobian.transpose() * jacobian / (sigma * sigma);
  }
  const Matrix6 covariance =
      problem.has_gravity
          ? SoftGravityCovariance(information, problem.gravity_in_camera, problem.gravity_sigma_rad)
          : FreeCovariance(information);
  const double position = limit.position_share * MedianInlierDepth(problem, pose);
  if (!(position > 0)) return false;
  const double with_all =
      ShareOfLimit(measurements.pose(), covariance, limit.rotation_rad, position);
  if (!(with_all <= 1.0)) return false;
  // Leaving one out by Woodbury's identity. Without an observation of leverage h (of its two rows
  // together, at least the larger eigenvalue) no variance grows by more than 1 / (1 - h).
  return std::all_of(jacobians.begin(), jacobians.end(), [&](const Jacobian26& left_out) {
    const Eigen::Matrix<double, 6, 2> gain = covariance * left_out.transpose();
    const Eigen::Matrix2d explained = left_out * gain;
    if (with_all <= 1.0 - explained.trace() / (sigma * sigma)) return true;
    const Eigen::Matrix2d redundancy = sigma * sigma * Eigen::Matrix2d::Identity() - explained;
    const double least = kLeastRedundancy * sigma * sigma;
    if (redundancy.determinant() < least * least) return false;
    return ShareOfLimit(measurements.pose(),
                        covariance + gain * redundancy.inverse() * gain.transpose(),
                        limit.rotation_rad, position) <= 1.0;
  });
}

}  // namespace maploc
