#include "server/solvers/up1p1l.h"

#include <cmath>
#include <limits>

#include "server/solvers/yaw_equation.h"

namespace maploc {

int SolveUp1p1l(const Eigen::Vector3d& ray, const Eigen::Vector3d& point,
                const Eigen::Vector3d& plane_normal, const Eigen::Vector3d& line_point,
                const Eigen::Vector3d& line_direction, AlignedPose aligned_from_map[2]) {
  const YawRoots roots = FindYawRoots(MakeYawEquation(plane_normal, line_direction));
  const double n_dot_x =
      plane_normal.x() * ray.x() + plane_normal.y() * ray.y() + plane_normal.z() * ray.z();
  // One division serves both: 1 / r2 and 1 / (n . x).
  const double product = roots.r2 * n_dot_x;
  const double inverse = 1.0 / product;
  const double by_r2 = inverse * n_dot_x;
  const double by_n_dot_x = inverse * roots.r2;
  const bool solvable = roots.real & (std::abs(product) >= std::numeric_limits<double>::min());
  const YawEquation height = MakeYawEquation(plane_normal, point - line_point);  // n . Rz (P - L)
  // Both are written and the valid ones kept by counting: no branch to mispredict.
  const Yaw first = roots.Root(-1.0, by_r2);
  const Yaw second = roots.Root(1.0, by_r2);
  const double depth1 = Value(height, first) * by_n_dot_x;
  const double depth2 = Value(height, second) * by_n_dot_x;
  const int keep1 = static_cast<int>(solvable & (depth1 > 0));
  const int keep2 = static_cast<int>(solvable & (depth2 > 0));
  WritePoseAtDepth(first, depth1, ray, point, &aligned_from_map[0]);
  WritePoseAtDepth(second, depth2, ray, point, &aligned_from_map[keep1]);
  return keep1 + keep2;
}

}  // namespace maploc
