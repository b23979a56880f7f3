#include "server/solvers/up1p2v.h"

#include <cmath>

#include "server/solvers/yaw_equation.h"

namespace maploc {
namespace {

// k1 n1 . Rz D1 - k2 n2 . Rz D2 = 0 with k1 = n2 . x, k2 = n1 . x, D_i = L_i - P.
struct Elimination {
  YawEquation first;
  YawEquation second;
  YawEquation difference;
};

YawEquation Scaled(const YawEquation& e, double factor) {
  return {e.a * factor, e.b * factor, e.c * factor};
}

Elimination Eliminate(double n1_dot_x, const Eigen::Vector3d& n1, const Eigen::Vector3d& d1,
                      double n2_dot_x, const Eigen::Vector3d& n2, const Eigen::Vector3d& d2) {
  Elimination result;
  result.first = Scaled(MakeYawEquation(n1, d1), n2_dot_x);
  result.second = Scaled(MakeYawEquation(n2, d2), n1_dot_x);
  result.difference = {result.first.a - result.second.a, result.first.b - result.second.b,
                       result.first.c - result.second.c};
  return result;
}

double Amplitude(const YawEquation& e) { return std::hypot(e.a, e.b); }

}  // namespace

int SolveUp1p2v(const Eigen::Vector3d& ray, const Eigen::Vector3d& point,
                const Eigen::Vector3d& plane_normal1, const Eigen::Vector3d& line_point1,
                const Eigen::Vector3d& plane_normal2, const Eigen::Vector3d& line_point2,
                AlignedPose aligned_from_map[2]) {
  const double n1_dot_x = plane_normal1.dot(ray);
  const double n2_dot_x = plane_normal2.dot(ray);
  if (n1_dot_x == 0 && n2_dot_x == 0) return 0;
  const Eigen::Vector3d d1 = line_point1 - point;
  const Eigen::Vector3d d2 = line_point2 - point;
  Yaw yaws[2];
  const int roots = SolveYaw(
      Eliminate(n1_dot_x, plane_normal1, d1, n2_dot_x, plane_normal2, d2).difference, yaws);
  const bool use_first = std::abs(n1_dot_x) >= std::abs(n2_dot_x);
  const Eigen::Vector3d& n = use_first ? plane_normal1 : plane_normal2;
  const Eigen::Vector3d& d = use_first ? d1 : d2;
  const double n_dot_x = use_first ? n1_dot_x : n2_dot_x;
  int count = 0;
  for (int i = 0; i < roots; ++i) {
    const double depth = -n.dot(TurnByYaw(yaws[i], d)) / n_dot_x;
    if (!(depth > 0)) continue;
    aligned_from_map[count++] = {yaws[i], depth * ray - TurnByYaw(yaws[i], point)};
  }
  return count;
}

double Up1p2vConditioning(const Eigen::Vector3d& ray, const Eigen::Vector3d& point,
                          const Eigen::Vector3d& plane_normal1, const Eigen::Vector3d& line_point1,
                          const Eigen::Vector3d& plane_normal2,
                          const Eigen::Vector3d& line_point2) {
  const Elimination e = Eliminate(plane_normal1.dot(ray), plane_normal1, line_point1 - point,
                                  plane_normal2.dot(ray), plane_normal2, line_point2 - point);
  const double scale = Amplitude(e.first) + Amplitude(e.second);
  return scale > 0 ? Amplitude(e.difference) / scale : 0.0;
}

}  // namespace maploc
