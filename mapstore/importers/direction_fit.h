// A measured direction with its uncertainty. All sources of gravity evidence use this one type, so
// that they can be reported, compared and combined.
#pragma once

#include <Eigen/Core>

namespace maploc {

struct DirectionFit {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // unit
  // Of small moves of its tip, rad^2, in the direction's own frame; nothing along it (rank 2).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

// Two unit vectors perpendicular to a unit vector and to each other.
Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& direction);

// The angle that holds the truth in 95 of 100 cases, along the direction that is known worst.
double Interval95Rad(const DirectionFit& fit);

// Squared distance of the two directions in units of their joint uncertainty: chi-square of 2
// degrees of freedom where both are sound. REQUIRES: less than a right angle apart.
double Distance2(const DirectionFit& a, const DirectionFit& b);

// Both combined, each weighted by its information. REQUIRES: less than a right angle apart.
DirectionFit Combine(const DirectionFit& a, const DirectionFit& b);

// What a covariance estimated from few residuals has to be multiplied by, so that 95% are 95%: the
// quantile of F(2, n) over that of chi-square / 2. REQUIRES: positive.
double SmallSampleFactor(double degrees_of_freedom);

}  // namespace maploc
