// The calibration estimated beside the pose. In the plane z = 1 a feature that the sent calibration
// has at u is truly at
//     u' = (u - c) (1 + k |u - c|^2) / s,
// s the true focal length over the sent one, c the principal point's error over the focal length, k
// the radial distortion that is missing. Errors are measured in the sent plane, where the features
// were found. Gauss-Newton over pose and (log s, c, k) with Cauchy's weights; inliers are gathered
// anew at every step.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "server/refinement/refine.h"
#include "server/solvers/reprojection.h"

namespace maploc {

// (log s, c_x, c_y, k).
using LensValues = Eigen::Vector4d;

// How the pose depends on the lens, and the information of the matches alone about the lens.
struct LensResponse {
  Eigen::Matrix<double, 6, 4> of_pose;  // d (w, d) / d lens, reprojection.h
  Eigen::Matrix4d information;
};

// Not thread-safe.
class LensFit {
 public:
  // `pose` was refined in `problem`, whose gravity, where it has one, is a measurement here too.
  LensFit(const PoseProblem& problem, const RefinedPose& pose, double threshold_px);

  // Starts at the result of the last fit. `prior`: standard deviations of the lens about the sent
  // one. False if there are too few inliers, or if no valid lens results.
  bool Fit(const LensValues& prior);
  // Whether the last fit ended. Otherwise it runs away: a flat, slightly bent map fits better the
  // longer the lens, and so does a picture from much farther away than its lens says.
  bool converged() const { return converged_; }
  // Within the threshold at the last step of the last fit.
  int features() const { return features_; }

  const LensValues& lens() const { return lens_; }
  const PoseMatrix& camera_from_moved_map() const { return pose_; }
  // Of the lens, with the last prior. Includes the noise of each coordinate and the landmarks'
  // common errors.
  Eigen::Matrix4d Covariance() const;
  // From the noise alone: the landmarks' common errors look like a pose change, not like a lens.
  LensResponse Response() const;
  // As RANSAC scores: a feature at the threshold is worth 0, one without error 1.
  double Support() const;

 private:
  struct Equations;

  Equations Sum() const;
  Eigen::Matrix<double, 10, 1> Step(const Equations& equations) const;
  template <typename Correspondence>
  double SupportOf(const std::vector<Correspondence>& features) const;

  const PoseProblem problem_;  // about an origin among its landmarks
  PoseMatrix pose_;
  LensValues lens_ = LensValues::Zero();
  LensValues prior_ = LensValues::Ones();
  bool converged_ = false;
  int features_ = 0;
  const double threshold_;          // plane z = 1
  const double sigma_;              // plane z = 1, RefinedPose::feature_sigma_px
  const double noise_information_;  // how much more the features are worth by their noise alone
  const std::size_t every_;         // n-th feature is looked at
};

}  // namespace maploc
