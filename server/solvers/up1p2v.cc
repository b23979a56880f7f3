#include "server/solvers/up1p2v.h"

#include <cmath>
#include <limits>

#include "server/solvers/yaw_equation.h"

namespace maploc {
namespace {

// factor1 e1 + factor2 e2.
YawEquation Combine(double factor1, const YawEquation& e1, double factor2, const YawEquation& e2) {
  return {factor1 * e1.a + factor2 * e2.a, factor1 * e1.b + factor2 * e2.b,
          factor1 * e1.c + factor2 * e2.c};
}

double Amplitude(const YawEquation& e) { return std::sqrt(e.a * e.a + e.b * e.b); }

double Dot(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

}  // namespace

int SolveUp1p2v(const Eigen::Vector3d& ray, const Eigen::Vector3d& point,
                const Eigen::Vector3d& plane_normal1, const Eigen::Vector3d& line_point1,
                const Eigen::Vector3d& plane_normal2, const Eigen::Vector3d& line_point2,
                AlignedPose aligned_from_map[2]) {
  const double n1_dot_x = Dot(plane_normal1, ray);
  const double n2_dot_x = Dot(plane_normal2, ray);
  const YawEquation e1 = MakeYawEquation(plane_normal1, line_point1 - point);
  const YawEquation e2 = MakeYawEquation(plane_normal2, line_point2 - point);
  const YawRoots roots = FindYawRoots(Combine(n2_dot_x, e1, -n1_dot_x, e2));
  // Both lines tell the depth, l (n_i . x) = -e_i: least squares.
  const YawEquation depth_equation = Combine(-n1_dot_x, e1, -n2_dot_x, e2);
  const double weight = n1_dot_x * n1_dot_x + n2_dot_x * n2_dot_x;
  const double product = roots.r2 * weight;
  const double inverse = 1.0 / product;
  const double by_r2 = inverse * weight;
  const double by_weight = inverse * roots.r2;
  const bool solvable = roots.real & (product >= std::numeric_limits<double>::min());
  // Both are written and the valid ones kept by counting: no branch to mispredict.
  const Yaw first = roots.Root(-1.0, by_r2);
  const Yaw second = roots.Root(1.0, by_r2);
  const double depth1 = Value(depth_equation, first) * by_weight;
  const double depth2 = Value(depth_equation, second) * by_weight;
  const int keep1 = static_cast<int>(solvable & (depth1 > 0));
  const int keep2 = static_cast<int>(solvable & (depth2 > 0));
  WritePoseAtDepth(first, depth1, ray, point, &aligned_from_map[0]);
  WritePoseAtDepth(second, depth2, ray, point, &aligned_from_map[keep1]);
  return keep1 + keep2;
}

double Up1p2vConditioning(const Eigen::Vector3d& ray, const Eigen::Vector3d& point,
                          const Eigen::Vector3d& plane_normal1, const Eigen::Vector3d& line_point1,
                          const Eigen::Vector3d& plane_normal2,
                          const Eigen::Vector3d& line_point2) {
  const double n1_dot_x = Dot(plane_normal1, ray);
  const double n2_dot_x = Dot(plane_normal2, ray);
  const YawEquation e1 = MakeYawEquation(plane_normal1, line_point1 - point);
  const YawEquation e2 = MakeYawEquation(plane_normal2, line_point2 - point);
  const double scale = std::abs(n2_dot_x) * Amplitude(e1) + std::abs(n1_dot_x) * Amplitude(e2);
  return scale > 0 ? Amplitude(Combine(n2_dot_x, e1, -n1_dot_x, e2)) / scale : 0.0;
}

}  // namespace maploc
