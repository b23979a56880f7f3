#include "server/trust/lens_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mapstore/geometry/gravity.h"
#include "server/refinement/covariance.h"

namespace maploc {
namespace {

using Vector10 = Eigen::Matrix<double, 10, 1>;
using Matrix10 = Eigen::Matrix<double, 10, 10>;
using Jacobian24 = Eigen::Matrix<double, 2, 4>;

constexpr int kMaxSteps = 40;
// Of a lens' values in one step: the equations are linear only so far, and a feature that a step
// moves past the threshold is lost.
constexpr double kLargestStep = 0.03;
constexpr double kSmallestStep = 1e-4;
// Past these it is no lens.
constexpr double kLargestLogScale = 2.0;
constexpr double kLargestDistortion = 5.0;
constexpr int kLeastFeatures = 20;  // twice the unknowns
// More do not tell more than what the map's own errors allow.
constexpr std::size_t kEnoughFeatures = 300;
constexpr double kLeastNoisePx = 0.3;  // no keypoint is placed better

Eigen::Vector2d Undo(const LensValues& lens, const Eigen::Vector2d& seen) {
  const Eigen::Vector2d u = seen - lens.segment<2>(1);
  return u * (1.0 + lens(3) * u.squaredNorm()) * std::exp(-lens(0));
}

// d Undo / d lens.
Jacobian24 UndoByLens(const LensValues& lens, const Eigen::Vector2d& seen) {
  const Eigen::Vector2d u = seen - lens.segment<2>(1);
  const double shrink = std::exp(-lens(0));
  const double bent = 1.0 + lens(3) * u.squaredNorm();
  Jacobian24 by_lens;
  by_lens.col(0) = -u * bent * shrink;
  by_lens.middleCols<2>(1) =
      -shrink * (bent * Eigen::Matrix2d::Identity() + 2.0 * lens(3) * u * u.transpose());
  by_lens.col(3) = u * u.squaredNorm() * shrink;
  return by_lens;
}

struct TwoRows {
  Eigen::Vector2d error;                  // in the sent calibration's plane z = 1
  Eigen::Matrix<double, 2, 10> jacobian;  // by (w, d), lens
};

// What a small length in the true plane is in the sent one, about a feature (the mean over its
// directions), and how it depends on the lens.
struct Stretch {
  double factor = 1.0;
  Eigen::RowVector4d by_lens;
};

Stretch StretchAt(const LensValues& lens, const Eigen::Vector2d& seen) {
  const Eigen::Vector2d u = seen - lens.segment<2>(1);
  const double bent = 1.0 + 2.0 * lens(3) * u.squaredNorm();
  Stretch stretch;
  stretch.factor = std::exp(lens(0)) / bent;
  stretch.by_lens << 1.0, 4.0 * lens(3) / bent * u.transpose(), -2.0 * u.squaredNorm() / bent;
  stretch.by_lens *= stretch.factor;
  return stretch;
}

// Errors are compared where the features were measured. In the true plane a longer lens makes all
// of them smaller, so that noise alone would ask for one.
void MeasureInSentPlane(const LensValues& lens, int row, const Eigen::Vector2d& seen,
                        TwoRows* rows) {
  const Stretch stretch = StretchAt(lens, seen);
  rows->jacobian.row(row) *= stretch.factor;
  rows->jacobian.row(row).tail<4>() += rows->error(row) * stretch.by_lens;
  rows->error(row) *= stretch.factor;
}

bool MakeRows(const PoseMatrix& pose, const PointCorrespondence& seen, const LensValues& lens,
              TwoRows* rows) {
  PointCorrespondence point = seen;
  point.normalized = Undo(lens, seen.normalized);
  Jacobian26 by_pose;
  if (!PointReprojection(pose, point, &rows->error, &by_pose)) return false;
  rows->jacobian << by_pose, -UndoByLens(lens, seen.normalized);
  for (int row = 0; row < 2; ++row) MeasureInSentPlane(lens, row, seen.normalized, rows);
  return true;
}

bool MakeRows(const PoseMatrix& pose, const LineCorrespondence& seen, const LensValues& lens,
              TwoRows* rows) {
  LineCorrespondence line = seen;
  line.normalized.start = Undo(lens, seen.normalized.start);
  line.normalized.end = Undo(lens, seen.normalized.end);
  Jacobian26 by_pose;
  if (!LineReprojection(pose, line, &rows->error, &by_pose)) return false;
  const Eigen::Vector3d start = pose.rotation * line.segment_in_map.start + pose.translation;
  const Eigen::Vector3d end = pose.rotation * line.segment_in_map.end + pose.translation;
  const Eigen::Vector2d normal = start.cross(end).head<2>().normalized();
  rows->jacobian.leftCols<6>() = by_pose;
  rows->jacobian.row(0).tail<4>() = normal.transpose() * UndoByLens(lens, seen.normalized.start);
  rows->jacobian.row(1).tail<4>() = normal.transpose() * UndoByLens(lens, seen.normalized.end);
  MeasureInSentPlane(lens, 0, seen.normalized.start, rows);
  MeasureInSentPlane(lens, 1, seen.normalized.end, rows);
  return true;
}

Eigen::Matrix3d Exp(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Eigen::Vector3d SomeLandmark(const PoseProblem& problem) {
  if (!problem.points.empty()) return problem.points.front().position_in_map;
  if (!problem.lines.empty()) return problem.lines.front().segment_in_map.start;
  return Eigen::Vector3d::Zero();
}

}  // namespace

struct LensFit::Equations {
  Matrix10 matrix = Matrix10::Zero();
  Vector10 right = Vector10::Zero();
  int features = 0;  // within the threshold

  template <typename Correspondence>
  void Add(const std::vector<Correspondence>& seen, const LensFit& fit) {
    const double loss = kLossScaleSigmas * fit.sigma_;
    TwoRows rows;
    for (std::size_t i = 0; i < seen.size(); i += fit.every_) {
      if (!MakeRows(fit.pose_, seen[i], fit.lens_, &rows)) continue;
      const double error2 = rows.error.squaredNorm();
      if (error2 >= fit.threshold_ * fit.threshold_) continue;
      const double weight = static_cast<double>(fit.every_) / (fit.sigma_ * fit.sigma_) /
                            (1.0 + error2 / (loss * loss));
      matrix.noalias() += weight * rows.jacobian.transpose() * rows.jacobian;
      right.noalias() -= weight * rows.jacobian.transpose() * rows.error;
      ++features;
    }
  }

  void AddGravity(const PoseProblem& problem, const PoseMatrix& pose) {
    const double sigma = std::max(problem.gravity_sigma_rad, kMinGravitySigmaRad);
    const Eigen::Vector3d& measured = problem.gravity_in_camera;
    const Eigen::Vector3d predicted = -pose.rotation.col(2);
    const Eigen::Matrix3d jacobian =
        measured.dot(predicted) * Eigen::Matrix3d::Identity() - predicted * measured.transpose();
    matrix.topLeftCorner<3, 3>() += jacobian.transpose() * jacobian / (sigma * sigma);
    right.head<3>() -= jacobian.transpose() * measured.cross(predicted) / (sigma * sigma);
  }

  Matrix10 WithPrior(const LensValues& prior) const {
    Matrix10 regular = matrix;
    regular.bottomRightCorner<4, 4>().diagonal() += prior.cwiseAbs2().cwiseInverse();
    return regular;
  }
};

LensFit::LensFit(const PoseProblem& problem, const RefinedPose& pose, double threshold_px)
    : problem_(MovedTo(problem, SomeLandmark(problem))),
      pose_(Rigid3{pose.camera_from_map.rotation, pose.camera_from_map * SomeLandmark(problem)}),
      threshold_(threshold_px / problem.focal_length_px),
      sigma_(pose.feature_sigma_px / problem.focal_length_px),
      noise_information_(
          std::pow(pose.feature_sigma_px / std::max(pose.inlier_rms_px, kLeastNoisePx), 2)),
      every_(1 + pose.InlierCount() / kEnoughFeatures) {}

bool LensFit::Fit(const LensValues& prior) {
  prior_ = prior;
  converged_ = false;
  for (int i = 0; i < kMaxSteps && !converged_; ++i) {
    const Equations equations = Sum();
    features_ = equations.features;
    if (features_ < kLeastFeatures) return false;
    const Vector10 step = Step(equations);
    if (!step.allFinite()) return false;
    pose_.rotation = Exp(step.head<3>()) * pose_.rotation;
    pose_.translation += step.segment<3>(3);
    lens_ += step.tail<4>();
    if (std::abs(lens_(0)) > kLargestLogScale || std::abs(lens_(3)) > kLargestDistortion) {
      return false;
    }
    converged_ = step.tail<4>().cwiseAbs().maxCoeff() < kSmallestStep;
  }
  return true;
}

Eigen::Matrix4d LensFit::Covariance() const {
  const Matrix10 covariance = Sum().WithPrior(prior_).inverse();
  return covariance.bottomRightCorner<4, 4>();
}

LensResponse LensFit::Response() const {
  const Matrix10 matrix = noise_information_ * Sum().matrix;
  const Eigen::Matrix<double, 6, 4> mixed = matrix.topRightCorner<6, 4>();
  LensResponse response;
  response.of_pose = -FreeCovariance(matrix.topLeftCorner<6, 6>()) * mixed;
  response.information = matrix.bottomRightCorner<4, 4>() + mixed.transpose() * response.of_pose;
  return response;
}

double LensFit::Support() const { return SupportOf(problem_.points) + SupportOf(problem_.lines); }

LensFit::Equations LensFit::Sum() const {
  Equations equations;
  equations.Add(problem_.points, *this);
  equations.Add(problem_.lines, *this);
  if (problem_.has_gravity) equations.AddGravity(problem_, pose_);
  return equations;
}

Eigen::Matrix<double, 10, 1> LensFit::Step(const Equations& equations) const {
  Vector10 right = equations.right;
  right.tail<4>() -= lens_.cwiseQuotient(prior_.cwiseAbs2());
  const Vector10 step = equations.WithPrior(prior_).ldlt().solve(right);
  // The whole step is shortened, because its pose and its lens were solved for together.
  return std::min(1.0, kLargestStep / step.tail<4>().cwiseAbs().maxCoeff()) * step;
}

template <typename Correspondence>
double LensFit::SupportOf(const std::vector<Correspondence>& features) const {
  double support = 0.0;
  TwoRows rows;
  for (std::size_t i = 0; i < features.size(); i += every_) {
    if (!MakeRows(pose_, features[i], lens_, &rows)) continue;
    support += std::max(0.0, 1.0 - rows.error.squaredNorm() / (threshold_ * threshold_));
  }
  return support;
}

}  // namespace maploc
