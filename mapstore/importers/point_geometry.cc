#include "mapstore/importers/point_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "mapstore/geometry/gravity.h"

namespace maploc {
namespace {

using Vector3 = Eigen::Vector3d;

Vector3 RayInMap(const PointObservation& view) {
  const Vector3 ray(view.normalized.x(), view.normalized.y(), 1.0);
  return (view.camera_from_map.rotation.conjugate() * ray).normalized();
}

// Smallest sum of squared distances to the rays: sum (I - r r^T) (X - c) = 0.
std::optional<Vector3> NearestToRays(std::span<const PointObservation> views) {
  constexpr double kMinConditioning = 1e-8;
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Vector3 right = Vector3::Zero();
  for (const PointObservation& view : views) {
    const Vector3 ray = RayInMap(view);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray * ray.transpose();
    matrix += across;
    right += across * view.camera_from_map.Inverse().translation;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  // Rays that are nearly parallel leave the distance open: the smallest eigenvalue is then near 0.
  if (!(solver.eigenvalues()(0) > kMinConditioning * solver.eigenvalues()(2))) return std::nullopt;
  return matrix.ldlt().solve(right);
}

// Derivative of the point's image in the plane z = 1 by its position. REQUIRES: it is in front.
Eigen::Matrix<double, 2, 3> NormalizedJacobian(const Rigid3& camera_from_map,
                                               const Vector3& point_in_map) {
  const Vector3 p = camera_from_map * point_in_map;
  Eigen::Matrix<double, 2, 3> projection;
  projection << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
  return projection * camera_from_map.rotation.toRotationMatrix();
}

bool Step(std::span<const PointObservation> views, Vector3& point) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Vector3 gradient = Vector3::Zero();
  for (const PointObservation& view : views) {
    const Vector3 p = view.camera_from_map * point;
    if (!(p.z() > 0)) return false;
    const Eigen::Vector2d residual = view.focal_length_px * (p.head<2>() / p.z() - view.normalized);
    const Eigen::Matrix<double, 2, 3> jacobian =
        view.focal_length_px * NormalizedJacobian(view.camera_from_map, point);
    const double weight = std::min(1.0, 1.0 / std::max(residual.norm(), 1e-12));
    information += weight * jacobian.transpose() * jacobian;
    gradient += weight * jacobian.transpose() * residual;
  }
  point -= information.ldlt().solve(gradient);
  return point.allFinite();
}

}  // namespace

double PointErrorPx(const PointObservation& seen, const Vector3& point_in_map) {
  const Vector3 p = seen.camera_from_map * point_in_map;
  if (!(p.z() > 0)) return std::numeric_limits<double>::max();
  return seen.focal_length_px * (p.head<2>() / p.z() - seen.normalized).norm();
}

double LargestParallax(std::span<const PointObservation> views, const Vector3& point_in_map) {
  double largest = 0;
  for (std::size_t a = 0; a < views.size(); ++a) {
    const Vector3 from_a =
        (point_in_map - views[a].camera_from_map.Inverse().translation).normalized();
    for (std::size_t b = a + 1; b < views.size(); ++b) {
      const Vector3 from_b =
          (point_in_map - views[b].camera_from_map.Inverse().translation).normalized();
      largest = std::max(largest, AngleBetween(from_a, from_b));
    }
  }
  return largest;
}

std::optional<Vector3> TriangulatePoint(std::span<const PointObservation> views) {
  constexpr int kSteps = 6;
  std::optional<Vector3> point = NearestToRays(views);
  if (!point) return std::nullopt;
  // A distance to a ray counts the same near and far. These steps minimize the errors in pixels
  // instead.
  for (int step = 0; step < kSteps; ++step) {
    if (!Step(views, *point)) return std::nullopt;
  }
  return point;
}

}  // namespace maploc
