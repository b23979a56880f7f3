#include "server/refinement/pose_residuals.h"

#include <cmath>

#include "mapstore/geometry/gravity.h"
#include "server/refinement/skew.h"

namespace maploc {
namespace {

Eigen::Matrix3d LeftJacobianOfSo3(const Eigen::Vector3d& w) {
  const double angle2 = w.squaredNorm();
  const Eigen::Matrix3d skew = Skew(w);
  // Taylor below the angle where 1 - cos loses half of its digits.
  if (angle2 < 1e-8) return Eigen::Matrix3d::Identity() + 0.5 * skew + skew * skew / 6.0;
  const double angle = std::sqrt(angle2);
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / angle2 * skew +
         (angle - std::sin(angle)) / (angle2 * angle) * skew * skew;
}

// A feature behind the camera, in sigmas: dearer than any inlier.
constexpr double kDoesNotProject = 1e3;

// sqrt(rho(s) / s) and its derivative by s, for Cauchy's loss of scale a.
struct LossFactor {
  double value = 1.0;
  double by_s = 0.0;
};

LossFactor CauchyFactor(double s, double a) {
  const double u = s / (a * a);
  double squared = 1.0 - u / 2 + u * u / 3;  // Taylor where the difference below loses its digits
  double squared_by_u = -0.5 + 2.0 / 3.0 * u;
  if (u > 1e-4) {
    const double log = std::log1p(u);
    squared = log / u;
    squared_by_u = (u / (1.0 + u) - log) / (u * u);
  }
  const double value = std::sqrt(squared);
  return {value, squared_by_u / (2.0 * value * a * a)};
}

// The outputs of one evaluation, two rows at a time.
class Rows {
 public:
  Rows(int count, int turns, double* residuals, double* jacobian)
      : residuals_(residuals, count),
        jacobian_(jacobian, jacobian != nullptr ? count : 0, turns + 3) {}

  bool wants_jacobian() const { return jacobian_.rows() > 0; }

  // `by_pose`: by (w, d), the left perturbation; `by_turn` = d w / d turn.
  void Add(const Eigen::Vector2d& residual, const Jacobian26& by_pose,
           const RotationChart::Basis& by_turn) {
    residuals_.segment<2>(row_) = residual;
    if (wants_jacobian()) {
      jacobian_.block(row_, 0, 2, by_turn.cols()).noalias() =
          by_pose.leftCols<3>().lazyProduct(by_turn);
      jacobian_.block<2, 3>(row_, by_turn.cols()) = by_pose.rightCols<3>();
    }
    row_ += 2;
  }

 private:
  Eigen::Map<Eigen::VectorXd> residuals_;
  Eigen::Map<Eigen::MatrixXd> jacobian_;
  int row_ = 0;
};

// Whitens and weighs one feature's error.
void AddFeature(bool projects, Eigen::Vector2d error, Jacobian26 jacobian,
                const ResidualScales& scales, const RotationChart::Basis& by_turn, Rows* rows) {
  if (!projects) {
    rows->Add(Eigen::Vector2d::Constant(kDoesNotProject), Jacobian26::Zero(), by_turn);
    return;
  }
  error /= scales.feature_sigma;
  const LossFactor factor = CauchyFactor(error.squaredNorm(), scales.loss_scale);
  if (rows->wants_jacobian()) {
    jacobian /= scales.feature_sigma;
    // d (factor e) = factor J + e d factor, with d factor = by_s d |e|^2 = 2 by_s e^T J.
    const Eigen::Matrix<double, 1, 6> along = error.transpose() * jacobian;
    jacobian = factor.value * jacobian + 2.0 * factor.by_s * error * along;
  }
  rows->Add(factor.value * error, jacobian, by_turn);
}

void AddGravity(const Eigen::Vector3d& measured, double sigma_rad, const Eigen::Matrix3d& rotation,
                const RotationChart::Basis& by_turn, Rows* rows) {
  const Eigen::Matrix<double, 2, 3> axes = PerpendicularBasis(measured).transpose() / sigma_rad;
  const Eigen::Vector3d predicted = -rotation.col(2);
  Jacobian26 jacobian = Jacobian26::Zero();
  // d predicted = w x predicted.
  jacobian.leftCols<3>() = -axes * Skew(measured) * Skew(predicted);
  rows->Add(axes * measured.cross(predicted), jacobian, by_turn);
}

Eigen::Vector3d TurnVector(const RotationChart& chart, const double* turn) {
  return chart.basis * Eigen::Map<const Eigen::VectorXd>(turn, chart.size());
}

}  // namespace

Eigen::Matrix3d RotationChart::Rotation(const double* turn) const {
  const Eigen::Vector3d w = TurnVector(*this, turn);
  const double angle = w.norm();
  if (angle == 0) return base_rotation;
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() * base_rotation;
}

RotationChart::Basis RotationChart::LeftJacobian(const double* turn) const {
  return LeftJacobianOfSo3(TurnVector(*this, turn)) * basis;
}

RotationChart FreeChart(const Eigen::Quaterniond& camera_from_map) {
  RotationChart chart;
  chart.base_rotation = camera_from_map.toRotationMatrix();
  chart.basis = Eigen::Matrix3d::Identity();
  return chart;
}

RotationChart YawChart(const Eigen::Quaterniond& camera_from_map,
                       const Eigen::Vector3d& gravity_in_camera) {
  // The shortest turn that takes the pose's gravity to the measured one.
  const Eigen::Quaterniond correction =
      Eigen::Quaterniond::FromTwoVectors(GravityInCamera(camera_from_map), gravity_in_camera);
  RotationChart chart;
  chart.base_rotation = (correction * camera_from_map).normalized().toRotationMatrix();
  chart.basis = gravity_in_camera;
  return chart;
}

PoseResiduals::PoseResiduals(const PoseProblem& problem, const InlierFlags& inliers,
                             const RotationChart& chart, const ResidualScales& scales)
    : problem_(problem), chart_(chart), scales_(scales) {
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (inliers.points[i] != 0) points_.push_back(i);
  }
  for (std::size_t i = 0; i < problem.lines.size(); ++i) {
    if (inliers.lines[i] != 0) lines_.push_back(i);
  }
  const bool gravity = scales.gravity_sigma_rad > 0;
  count_ = 2 * static_cast<int>(points_.size() + lines_.size() + (gravity ? 1 : 0));
}

void PoseResiduals::Evaluate(const double* parameters, double* residuals, double* jacobian) const {
  PoseMatrix pose;
  pose.rotation = chart_.Rotation(parameters);
  pose.translation = Eigen::Map<const Eigen::Vector3d>(parameters + chart_.size());
  const RotationChart::Basis by_turn = chart_.LeftJacobian(parameters);
  Rows rows(count_, chart_.size(), residuals, jacobian);
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
  Jacobian26 by_pose = Jacobian26::Zero();
  Jacobian26* const wanted = rows.wants_jacobian() ? &by_pose : nullptr;
  for (const std::size_t i : points_) {
    const bool projects = PointReprojection(pose, problem_.points[i], &error, wanted);
    AddFeature(projects, error, by_pose, scales_, by_turn, &rows);
  }
  for (const std::size_t i : lines_) {
    const bool projects = LineReprojection(pose, problem_.lines[i], &error, wanted);
    AddFeature(projects, error, by_pose, scales_, by_turn, &rows);
  }
  if (scales_.gravity_sigma_rad > 0) {
    AddGravity(problem_.gravity_in_camera, scales_.gravity_sigma_rad, pose.rotation, by_turn,
               &rows);
  }
}

Eigen::Matrix<double, 3, 2> PerpendicularBasis(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.unitOrthogonal();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

}  // namespace maploc
