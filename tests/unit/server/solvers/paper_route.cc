#include "tests/unit/server/solvers/paper_route.h"

#include <cmath>

#include "mapstore/geometry/gravity.h"

namespace maploc::testing {
namespace {

// v . Rz(alpha) p = a cos(alpha) + b sin(alpha) + c.
struct Sinusoid {
  double a, b, c;
};

Sinusoid RowTimesPoint(const Eigen::Vector3d& v, const Eigen::Vector3d& p) {
  return {v.x() * p.x() + v.y() * p.y(), v.y() * p.x() - v.x() * p.y(), v.z() * p.z()};
}

// a cos + b sin = -c  <=>  cos(alpha - atan2(b, a)) = -c / hypot(a, b).
std::vector<double> Angles(const Sinusoid& s) {
  const double cosine = -s.c / std::hypot(s.a, s.b);
  if (!(std::abs(cosine) <= 1)) return {};
  const double phase = std::atan2(s.b, s.a);
  return {phase + std::acos(cosine), phase - std::acos(cosine)};
}

Eigen::Matrix3d Rz(double alpha) {
  return Eigen::AngleAxisd(alpha, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

std::vector<Rigid3> PaperOnePointOneLine(const Eigen::Vector3d& gravity_in_camera,
                                         const Eigen::Vector3d& ray1, const Eigen::Vector3d& point1,
                                         const Eigen::Vector3d& ray2, const Eigen::Vector3d& ray3,
                                         const Eigen::Vector3d& line2,
                                         const Eigen::Vector3d& line3) {
  const Eigen::Matrix3d camera_from_aligned =
      CameraFromAligned(gravity_in_camera).toRotationMatrix();
  // C1: the camera's centre at (0, 0, -1), d2 along z, d3 in the xz plane.
  const Eigen::Vector3d d2 = ray2.normalized();
  const Eigen::Vector3d d3 = ray3.normalized();
  Eigen::Matrix3d c1_from_camera;
  c1_from_camera.row(2) = d2;
  c1_from_camera.row(0) = (d3 / d2.dot(d3) - d2).normalized();
  c1_from_camera.row(1) = d2.cross(Eigen::Vector3d(c1_from_camera.row(0)));
  const Eigen::Vector3d centre(0, 0, -1);
  // D1 = (a1, b1, 0) on the ray of the point.
  const Eigen::Vector3d turned = c1_from_camera * ray1;
  const double a1 = turned.x() / turned.z();
  const double b1 = turned.y() / turned.z();
  // W1: the map moved so that the point is its origin.
  const Eigen::Vector3d l2 = line2 - point1;
  const Eigen::Vector3d l3 = line3 - point1;
  const Eigen::Matrix3d c1_from_aligned = c1_from_camera * camera_from_aligned;
  const Eigen::Vector3d row2 = c1_from_aligned.row(1);
  std::vector<Rigid3> poses;
  for (const double alpha : Angles(RowTimesPoint(row2, l3 - l2))) {  // (5) - (4)
    const Eigen::Matrix3d rotation = c1_from_aligned * Rz(alpha);    // C1 from W1
    const double t2 = -rotation.row(1).dot(l2);                      // (4)
    const double t1 = a1 * t2 / b1;                                  // (2)
    const double t3 = (t2 - b1) / b1;                                // (3)
    const Eigen::Vector3d translation(t1, t2, t3);
    Rigid3 pose;
    const Eigen::Matrix3d camera_from_map = c1_from_camera.transpose() * rotation;
    pose.rotation = Eigen::Quaterniond(camera_from_map).normalized();
    pose.translation =
        c1_from_camera.transpose() * (translation - centre) - camera_from_map * point1;
    if ((pose * point1).dot(ray1) > 0) poses.push_back(pose);
  }
  return poses;
}

std::vector<Rigid3> PaperTwoPoints(const Eigen::Vector3d& gravity_in_camera,
                                   const Eigen::Vector3d& ray1, const Eigen::Vector3d& point1,
                                   const Eigen::Vector3d& ray2, const Eigen::Vector3d& point2) {
  const Eigen::Matrix3d camera_from_aligned =
      CameraFromAligned(gravity_in_camera).toRotationMatrix();
  const double a1 = ray1.x(), b1 = ray1.y();
  const double a2 = ray2.x(), b2 = ray2.y();
  const Eigen::Vector3d p2 = point2 - point1;  // W1
  const Eigen::Vector3d r1 = camera_from_aligned.row(0);
  const Eigen::Vector3d r2 = camera_from_aligned.row(1);
  const Eigen::Vector3d r3 = camera_from_aligned.row(2);
  // (6), (7): T1 = a1 T3, T2 = b1 T3. In (8): (a2 r2 - b2 r1) P2 + (a2 b1 - b2 a1) T3 = 0,
  // in (9): (a2 r3 - r1) P2 + (a2 - a1) T3 = 0. Eliminate T3.
  const Eigen::Vector3d eliminated =
      (a2 * b1 - b2 * a1) * (a2 * r3 - r1) - (a2 - a1) * (a2 * r2 - b2 * r1);
  std::vector<Rigid3> poses;
  for (const double alpha : Angles(RowTimesPoint(eliminated, p2))) {
    const Eigen::Matrix3d rotation = camera_from_aligned * Rz(alpha);
    const Eigen::Vector3d q = rotation * p2;
    const double t3 = std::abs(a2 - a1) > std::abs(a2 * b1 - b2 * a1)
                          ? -(a2 * q.z() - q.x()) / (a2 - a1)
                          : -(a2 * q.y() - b2 * q.x()) / (a2 * b1 - b2 * a1);
    const Eigen::Vector3d translation(a1 * t3, b1 * t3, t3);
    if (!(t3 > 0 && q.z() + t3 > 0)) continue;
    poses.push_back({Eigen::Quaterniond(rotation).normalized(), translation - rotation * point1});
  }
  return poses;
}

}  // namespace maploc::testing
