#include "server/solvers/p3p.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace maploc {
namespace {

// Sides and cosines of the problem. bij = -2 yi.yj, aij = |Pi - Pj|^2.
struct Quadrics {
  double a12, a13, a23;
  double b12, b13, b23;
};

// A real root of x^3 + b x^2 + c x + d, away from double roots where there are three: from the far
// side of the turning points, where Newton converges monotonically.
double OneCubicRoot(double b, double c, double d) {
  const auto value = [&](double x) { return ((x + b) * x + c) * x + d; };
  const double discriminant = b * b - 3.0 * c;
  double x = -b / 3.0;
  if (discriminant >= 0) {
    const double spread = std::sqrt(discriminant) / 3.0;
    const double high = x + spread;  // local minimum of the cubic
    const double low = x - spread;   // local maximum
    // Start outside of the turning point whose side holds the outer root.
    x = value(high) <= 0 ? high + std::sqrt(std::max(-value(high) / (3.0 * high + b), 0.0))
                         : low - std::sqrt(std::max(-value(low) / (3.0 * low + b), 0.0));
    if (!std::isfinite(x)) x = value(high) <= 0 ? high + spread : low - spread;
  } else if (std::abs(3.0 * x * x + 2.0 * b * x + c) < 0.25) {
    x += 1.0;
  }
  for (int i = 0; i < 50; ++i) {
    const double slope = (3.0 * x + 2.0 * b) * x + c;
    if (slope == 0) break;
    const double step = value(x) / slope;
    x -= step;
    if (std::abs(step) <= 1e-15 * std::max(1.0, std::abs(x))) break;
  }
  return x;
}

// Lambda Twist, equations (11)-(14): coefficients of det(D1 + g D2) = 0.
double PencilRoot(const Quadrics& q) {
  const double c12 = -0.5 * q.b12, c13 = -0.5 * q.b13, c23 = -0.5 * q.b23;
  const double blob = c12 * c23 * c13 - 1.0;
  const double s12 = 1.0 - c12 * c12, s13 = 1.0 - c13 * c13, s23 = 1.0 - c23 * c23;
  const double p3 = q.a13 * (q.a23 * s13 - q.a13 * s23);
  const double p2 = 2.0 * blob * q.a23 * q.a13 + q.a13 * (2.0 * q.a12 + q.a13) * s23 +
                    q.a23 * (q.a23 - q.a12) * s13;
  const double p1 = q.a23 * (q.a13 - q.a23) * s12 - q.a12 * q.a12 * s23 -
                    2.0 * q.a12 * (blob * q.a23 + q.a13 * s23);
  const double p0 = q.a12 * (q.a12 * s23 - q.a23 * s12);
  // The reciprocal polynomial where the leading coefficient is the smaller one.
  if (std::abs(p3) >= std::abs(p0)) return OneCubicRoot(p2 / p3, p1 / p3, p0 / p3);
  return 1.0 / OneCubicRoot(p1 / p0, p2 / p0, p3 / p0);
}

// Eigen decomposition of the degenerate quadric (one eigenvalue is 0): the two others, larger
// magnitude first.
struct PlanePair {
  double values[2];
  Eigen::Vector3d vectors[2];
};

PlanePair DecomposeDegenerate(const Eigen::Matrix3d& m) {
  const double b = -m.trace();
  const double c = m(0, 0) * (m(1, 1) + m(2, 2)) + m(1, 1) * m(2, 2) - m(0, 1) * m(0, 1) -
                   m(0, 2) * m(0, 2) - m(1, 2) * m(1, 2);
  const double root = std::sqrt(std::max(b * b - 4.0 * c, 0.0));
  const double far = b > 0 ? 0.5 * (-b - root) : 0.5 * (-b + root);
  PlanePair pair;
  pair.values[0] = far;
  pair.values[1] = far != 0 ? c / far : 0.0;
  for (int i = 0; i < 2; ++i) {
    // The eigenvector is perpendicular to the rows of m - value I; take the longest cross product.
    const Eigen::Matrix3d shifted = m - pair.values[i] * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d candidates[3] = {
        shifted.row(0).transpose().cross(shifted.row(1).transpose()),
        shifted.row(0).transpose().cross(shifted.row(2).transpose()),
        shifted.row(1).transpose().cross(shifted.row(2).transpose())};
    const Eigen::Vector3d* best = &candidates[0];
    for (const Eigen::Vector3d& candidate : candidates) {
      if (candidate.squaredNorm() > best->squaredNorm()) best = &candidate;
    }
    pair.vectors[i] = best->normalized();
  }
  return pair;
}

// Gauss and Newton on the three distance equations; a few steps reach machine precision.
void PolishDepths(const Quadrics& q, Eigen::Vector3d* depths) {
  double& l1 = (*depths)(0);
  double& l2 = (*depths)(1);
  double& l3 = (*depths)(2);
  for (int i = 0; i < 10; ++i) {
    const double r1 = l1 * l1 + l2 * l2 + q.b12 * l1 * l2 - q.a12;
    const double r2 = l1 * l1 + l3 * l3 + q.b13 * l1 * l3 - q.a13;
    const double r3 = l2 * l2 + l3 * l3 + q.b23 * l2 * l3 - q.a23;
    if (std::abs(r1) + std::abs(r2) + std::abs(r3) < 1e-15 * (q.a12 + q.a13 + q.a23)) break;
    const double j11 = 2 * l1 + q.b12 * l2, j12 = 2 * l2 + q.b12 * l1;
    const double j21 = 2 * l1 + q.b13 * l3, j23 = 2 * l3 + q.b13 * l1;
    const double j32 = 2 * l2 + q.b23 * l3, j33 = 2 * l3 + q.b23 * l2;
    const double determinant = -j11 * j23 * j32 - j12 * j21 * j33;
    if (determinant == 0) break;
    const double inverse = 1.0 / determinant;
    l1 -= inverse * (-j23 * j32 * r1 - j12 * j33 * r2 + j12 * j23 * r3);
    l2 -= inverse * (-j21 * j33 * r1 + j11 * j33 * r2 - j11 * j23 * r3);
    l3 -= inverse * (j21 * j32 * r1 - j11 * j32 * r2 - j12 * j21 * r3);
  }
}

// Depths on the plane l1 = w0 l2 + w1 l3. Returns how many were written, at most 2.
int DepthsOnPlane(const Quadrics& q, double w0, double w1, Eigen::Vector3d* depths) {
  // With tau = l3 / l2: the quadric a13 (12) - a12 (13) restricted to the plane.
  const double a = (q.a13 - q.a12) * w1 * w1 - q.a12 * q.b13 * w1 - q.a12;
  const double b = q.a13 * q.b12 * w1 - q.a12 * q.b13 * w0 - 2.0 * w0 * w1 * (q.a12 - q.a13);
  const double c = (q.a13 - q.a12) * w0 * w0 + q.a13 * q.b12 * w0 + q.a13;
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant < 0) return 0;
  const double far = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  const double taus[2] = {far / a, c / far};
  int count = 0;
  for (const double tau : taus) {
    if (!(tau > 0) || !std::isfinite(tau)) continue;
    const double l2 = std::sqrt(q.a23 / (tau * (q.b23 + tau) + 1.0));
    const double l3 = tau * l2;
    const double l1 = w0 * l2 + w1 * l3;
    if (l1 > 0 && std::isfinite(l1)) depths[count++] = {l1, l2, l3};
  }
  return count;
}

// R maps the map's triangle onto the camera's: both as a basis of two edges and their normal.
Rigid3 PoseFromDepths(const Eigen::Vector3d y[3], const Eigen::Vector3d points[3],
                      const Eigen::Matrix3d& inverse_map_basis, const Eigen::Vector3d& depths) {
  const Eigen::Vector3d e1 = depths(0) * y[0] - depths(1) * y[1];
  const Eigen::Vector3d e2 = depths(0) * y[0] - depths(2) * y[2];
  Eigen::Matrix3d camera_basis;
  camera_basis << e1, e2, e1.cross(e2);
  const Eigen::Matrix3d rotation = camera_basis * inverse_map_basis;
  return {Eigen::Quaterniond(rotation).normalized(), depths(0) * y[0] - rotation * points[0]};
}

}  // namespace

int SolveP3p(const Eigen::Vector3d rays[3], const Eigen::Vector3d points[3],
             Rigid3 camera_from_map[4]) {
  const Eigen::Vector3d y[3] = {rays[0].normalized(), rays[1].normalized(), rays[2].normalized()};
  const Eigen::Vector3d d12 = points[0] - points[1];
  const Eigen::Vector3d d13 = points[0] - points[2];
  const Quadrics q = {
      d12.squaredNorm(),     d13.squaredNorm(),     (points[1] - points[2]).squaredNorm(),
      -2.0 * y[0].dot(y[1]), -2.0 * y[0].dot(y[2]), -2.0 * y[1].dot(y[2])};
  Eigen::Matrix3d map_basis;
  map_basis << d12, d13, d12.cross(d13);
  if (!(map_basis.col(2).squaredNorm() > 0)) return 0;
  const double g = PencilRoot(q);
  if (!std::isfinite(g)) return 0;

  Eigen::Matrix3d m;  // D1 + g D2
  m(0, 0) = q.a23 * (1.0 - g);
  m(0, 1) = m(1, 0) = 0.5 * q.a23 * q.b12;
  m(0, 2) = m(2, 0) = -0.5 * q.a23 * q.b13 * g;
  m(1, 1) = q.a23 - q.a12 + q.a13 * g;
  m(1, 2) = m(2, 1) = 0.5 * q.b23 * (q.a13 * g - q.a12);
  m(2, 2) = g * (q.a13 - q.a23) - q.a12;
  const PlanePair pair = DecomposeDegenerate(m);
  if (pair.values[0] == 0) return 0;

  const Eigen::Matrix3d inverse_map_basis = map_basis.inverse();
  const double ratio = std::sqrt(std::max(-pair.values[1] / pair.values[0], 0.0));
  int count = 0;
  for (const double s : {ratio, -ratio}) {
    // The plane's normal v0 - s v1; solved for l1.
    const Eigen::Vector3d normal = pair.vectors[0] - s * pair.vectors[1];
    Eigen::Vector3d depths[2];
    const int found = DepthsOnPlane(q, -normal.y() / normal.x(), -normal.z() / normal.x(), depths);
    for (int i = 0; i < found; ++i) {
      PolishDepths(q, &depths[i]);
      if (!(depths[i].minCoeff() > 0) || !depths[i].allFinite()) continue;
      camera_from_map[count++] = PoseFromDepths(y, points, inverse_map_basis, depths[i]);
    }
  }
  return count;
}

double P3pConditioning(const Eigen::Vector3d rays[3], const Eigen::Vector3d points[3]) {
  const auto smallest_sine = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    const double scale = a.norm() * b.norm();
    return scale > 0 ? a.cross(b).norm() / scale : 0.0;
  };
  const Eigen::Vector3d edges[3] = {points[1] - points[0], points[2] - points[1],
                                    points[0] - points[2]};
  double in_map = 1.0;
  double in_image = 1.0;
  for (int i = 0; i < 3; ++i) {
    in_map = std::min(in_map, smallest_sine(edges[i], edges[(i + 1) % 3]));
    in_image = std::min(in_image, smallest_sine(rays[i], rays[(i + 1) % 3]));
  }
  return in_map * in_image;
}

}  // namespace maploc
