#include "mapstore/importers/direction_fit.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace maploc {
namespace {

constexpr double kChiSquare2At95 = 5.991465;

}  // namespace

Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.unitOrthogonal();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

double Interval95Rad(const DirectionFit& fit) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(fit.covariance,
                                                              Eigen::EigenvaluesOnly);
  return std::sqrt(kChiSquare2At95 * std::max(0.0, solver.eigenvalues()(2)));
}

double Distance2(const DirectionFit& a, const DirectionFit& b) {
  const Eigen::Matrix<double, 3, 2> basis = TangentBasis((a.direction + b.direction).normalized());
  const Eigen::Vector2d difference = basis.transpose() * (b.direction - a.direction);
  const Eigen::Matrix2d joint = basis.transpose() * (a.covariance + b.covariance) * basis;
  return difference.dot(joint.inverse() * difference);
}

DirectionFit Combine(const DirectionFit& a, const DirectionFit& b) {
  const Eigen::Matrix<double, 3, 2> basis = TangentBasis(a.direction);
  // A direction's 3x3 covariance has rank 2, so it is inverted in the tangent plane.
  const Eigen::Matrix2d information_a = (basis.transpose() * a.covariance * basis).inverse();
  const Eigen::Matrix2d information_b = (basis.transpose() * b.covariance * basis).inverse();
  const Eigen::Matrix2d covariance = (information_a + information_b).inverse();
  const Eigen::Vector2d move =
      covariance * information_b * basis.transpose() * (b.direction - a.direction);
  return {(a.direction + basis * move).normalized(), basis * covariance * basis.transpose()};
}

double SmallSampleFactor(double degrees_of_freedom) {
  // P(F(2, n) > f) = (1 + 2 f / n)^(-n / 2), solved for 2 f at 5%.
  const double twice_f = degrees_of_freedom * (std::pow(0.05, -2.0 / degrees_of_freedom) - 1.0);
  return twice_f / kChiSquare2At95;
}

}  // namespace maploc
