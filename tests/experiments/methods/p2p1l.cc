#include "tests/experiments/methods/p2p1l.h"

#include <cmath>

#include <Eigen/Geometry>

namespace maploc {
namespace {

// Rounding may take the discriminant of a double root below zero, by this share of its terms.
constexpr double kDoubleRoot = 1e-12;

// The ratios cos : sin with a cos^2 + 2 b cos sin + c sin^2 = 0, as unit vectors. Returns how many.
int SolveHomogeneous(double a, double b, double c, Eigen::Vector2d cosine_sine[2]) {
  const double discriminant = b * b - a * c;
  if (discriminant < -kDoubleRoot * (b * b + std::abs(a * c))) return 0;
  const double q = -(b + std::copysign(std::sqrt(std::max(discriminant, 0.0)), b));
  const Eigen::Vector2d ratios[2] = {{q, a}, {c, q}};
  int count = 0;
  for (const Eigen::Vector2d& ratio : ratios) {
    const double norm = ratio.norm();
    if (norm > 0) cosine_sine[count++] = ratio / norm;
  }
  return count;
}

// Rows: `first`, the part of `second` across it, and their cross product, all unit.
Eigen::Matrix3d Triad(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  const Eigen::Vector3d across = (second - first.dot(second) * first).normalized();
  Eigen::Matrix3d rows;
  rows << first.transpose(), across.transpose(), first.cross(across).transpose();
  return rows;
}

}  // namespace

int SolveP2p1l(const Eigen::Vector3d rays[2], const Eigen::Vector3d points[2],
               const Eigen::Vector3d& plane_normal, const Eigen::Vector3d& line_point,
               const Eigen::Vector3d& line_direction, Rigid3 camera_from_map[8]) {
  const Eigen::Vector3d n = plane_normal.normalized();
  const Eigen::Vector3d x[2] = {rays[0].normalized(), rays[1].normalized()};
  const Eigen::Vector3d pair = points[1] - points[0];
  const double n_dot_x[2] = {n.dot(x[0]), n.dot(x[1])};
  if (n_dot_x[0] == 0 || n_dot_x[1] == 0) return 0;
  const Eigen::Vector3d u = line_direction.unitOrthogonal();
  const Eigen::Vector3d v = line_direction.normalized().cross(u);

  // l_i = cosine depth_u[i] + sine depth_v[i].
  double depth_u[2];
  double depth_v[2];
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d from_line = points[i] - line_point;
    depth_u[i] = u.dot(from_line) / n_dot_x[i];
    depth_v[i] = v.dot(from_line) / n_dot_x[i];
  }
  const double cosine = x[0].dot(x[1]);
  const auto distance_form = [&](const double a[2], const double b[2]) {
    return a[0] * b[0] + a[1] * b[1] - cosine * (a[0] * b[1] + a[1] * b[0]);
  };
  const double distance2 = pair.squaredNorm();
  Eigen::Vector2d roots[2];
  const int found =
      SolveHomogeneous(distance_form(depth_u, depth_u) - distance2, distance_form(depth_u, depth_v),
                       distance_form(depth_v, depth_v) - distance2, roots);
  int count = 0;
  for (int k = 0; k < found; ++k) {
    Eigen::Vector2d root = roots[k];
    if (root(0) * depth_u[0] + root(1) * depth_v[0] < 0) root = -root;
    const double depth1 = root(0) * depth_u[0] + root(1) * depth_v[0];
    const double depth2 = root(0) * depth_u[1] + root(1) * depth_v[1];
    if (!(depth1 > 0 && depth2 > 0)) continue;
    const Eigen::Vector3d n_in_map = root(0) * u + root(1) * v;
    const Eigen::Matrix3d rotation =
        Triad(n, depth2 * x[1] - depth1 * x[0]).transpose() * Triad(n_in_map, pair);
    if (!rotation.allFinite()) continue;
    camera_from_map[count++] = {Eigen::Quaterniond(rotation).normalized(),
                                depth1 * x[0] - rotation * points[0]};
  }
  return count;
}

}  // namespace maploc
