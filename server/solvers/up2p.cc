#include "server/solvers/up2p.h"

#include <limits>

#include <Eigen/Geometry>

#include "server/solvers/yaw_equation.h"

namespace maploc {

int SolveUp2p(const Eigen::Vector3d& ray1, const Eigen::Vector3d& point1,
              const Eigen::Vector3d& ray2, const Eigen::Vector3d& point2,
              AlignedPose aligned_from_map[2]) {
  const Eigen::Vector3d n = ray1.cross(ray2);
  const Eigen::Vector3d d = point2 - point1;
  const YawRoots roots = FindYawRoots(MakeYawEquation(n, d));
  const double n2 = n.x() * n.x() + n.y() * n.y() + n.z() * n.z();
  // One division serves both: 1 / r2 and 1 / |n|^2.
  const double product = roots.r2 * n2;
  const double inverse = 1.0 / product;
  const double by_r2 = inverse * n2;
  const double by_n2 = inverse * roots.r2;
  const bool solvable = roots.real & (product >= std::numeric_limits<double>::min());
  // l1 = -(Rz D x x2) . n / |n|^2 = (n x x2) . Rz D / |n|^2, and the same with x1 for l2.
  const YawEquation to_depth1 = MakeYawEquation(n.cross(ray2), d);
  const YawEquation to_depth2 = MakeYawEquation(n.cross(ray1), d);
  // Both are written and the valid ones kept by counting: no branch to mispredict.
  const Yaw first = roots.Root(-1.0, by_r2);
  const Yaw second = roots.Root(1.0, by_r2);
  const double depth1 = Value(to_depth1, first) * by_n2;
  const double depth2 = Value(to_depth1, second) * by_n2;
  const int keep1 = static_cast<int>(solvable & (depth1 > 0) & (Value(to_depth2, first) > 0));
  const int keep2 = static_cast<int>(solvable & (depth2 > 0) & (Value(to_depth2, second) > 0));
  WritePoseAtDepth(first, depth1, ray1, point1, &aligned_from_map[0]);
  WritePoseAtDepth(second, depth2, ray1, point1, &aligned_from_map[keep1]);
  return keep1 + keep2;
}

}  // namespace maploc
