#include "server/refinement/cost_functions.h"

#include <cmath>

#include "mapstore/geometry/gravity.h"

namespace maploc {
namespace {

Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d LeftJacobianOfSo3(const Eigen::Vector3d& w) {
  const double angle2 = w.squaredNorm();
  const Eigen::Matrix3d skew = Skew(w);
  // Taylor below the angle where 1 - cos loses half of its digits.
  if (angle2 < 1e-8) return Eigen::Matrix3d::Identity() + 0.5 * skew + skew * skew / 6.0;
  const double angle = std::sqrt(angle2);
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / angle2 * skew +
         (angle - std::sin(angle)) / (angle2 * angle) * skew * skew;
}

using RowJacobian = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor, 2, 3>;

// Shared by points and lines, which differ in the error alone.
template <typename Correspondence,
          bool (*Error)(const PoseMatrix&, const Correspondence&, Eigen::Vector2d*, Jacobian26*)>
class ReprojectionCost final : public ceres::CostFunction {
 public:
  ReprojectionCost(const RotationChart& chart, const Correspondence& seen, double sigma)
      : chart_(chart), seen_(seen), inverse_sigma_(1.0 / sigma) {
    set_num_residuals(2);
    mutable_parameter_block_sizes()->assign({chart.size(), 3});
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    PoseMatrix pose;
    pose.rotation = chart_.Rotation(parameters[0]);
    pose.translation = Eigen::Map<const Eigen::Vector3d>(parameters[1]);
    Eigen::Vector2d error;
    Jacobian26 jacobian;
    if (!Error(pose, seen_, &error, jacobians != nullptr ? &jacobian : nullptr)) return false;
    Eigen::Map<Eigen::Vector2d> whitened(residuals);
    whitened = inverse_sigma_ * error;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      const RowJacobian by_turn =
          inverse_sigma_ * jacobian.leftCols<3>() * chart_.LeftJacobian(parameters[0]);
      Eigen::Map<RowJacobian> out(jacobians[0], 2, chart_.size());
      out = by_turn;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> by_translation(jacobians[1]);
      by_translation = inverse_sigma_ * jacobian.rightCols<3>();
    }
    return true;
  }

 private:
  const RotationChart& chart_;
  const Correspondence& seen_;
  const double inverse_sigma_;
};

class GravityCost final : public ceres::CostFunction {
 public:
  GravityCost(const RotationChart& chart, const Eigen::Vector3d& gravity_in_camera,
              double sigma_rad)
      : chart_(chart),
        measured_(gravity_in_camera),
        axes_(PerpendicularBasis(gravity_in_camera)),
        inverse_sigma_(1.0 / sigma_rad) {
    set_num_residuals(2);
    mutable_parameter_block_sizes()->assign({chart.size()});
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Vector3d predicted = -chart_.Rotation(parameters[0]).col(2);
    Eigen::Map<Eigen::Vector2d> residual(residuals);
    residual = inverse_sigma_ * (axes_.transpose() * measured_.cross(predicted));
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    // d predicted = w x predicted.
    const Eigen::Matrix<double, 2, 3> by_w =
        -inverse_sigma_ * axes_.transpose() * Skew(measured_) * Skew(predicted);
    const RowJacobian by_turn = by_w * chart_.LeftJacobian(parameters[0]);
    Eigen::Map<RowJacobian> out(jacobians[0], 2, chart_.size());
    out = by_turn;
    return true;
  }

 private:
  const RotationChart& chart_;
  const Eigen::Vector3d measured_;
  const Eigen::Matrix<double, 3, 2> axes_;
  const double inverse_sigma_;
};

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

Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> RotationChart::LeftJacobian(
    const double* turn) const {
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

std::unique_ptr<ceres::CostFunction> MakePointCost(const RotationChart& chart,
                                                   const PointCorrespondence& point, double sigma) {
  return std::make_unique<ReprojectionCost<PointCorrespondence, PointReprojection>>(chart, point,
                                                                                    sigma);
}

std::unique_ptr<ceres::CostFunction> MakeLineCost(const RotationChart& chart,
                                                  const LineCorrespondence& line, double sigma) {
  return std::make_unique<ReprojectionCost<LineCorrespondence, LineReprojection>>(chart, line,
                                                                                  sigma);
}

std::unique_ptr<ceres::CostFunction> MakeGravityCost(const RotationChart& chart,
                                                     const Eigen::Vector3d& gravity_in_camera,
                                                     double sigma_rad) {
  return std::make_unique<GravityCost>(chart, gravity_in_camera, sigma_rad);
}

Eigen::Matrix<double, 3, 2> PerpendicularBasis(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.unitOrthogonal();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

}  // namespace maploc
