#include "server/solvers/up2p.h"

#include "server/solvers/yaw_equation.h"

namespace maploc {

int SolveUp2p(const Eigen::Vector3d& ray1, const Eigen::Vector3d& point1,
              const Eigen::Vector3d& ray2, const Eigen::Vector3d& point2,
              AlignedPose aligned_from_map[2]) {
  const Eigen::Vector3d n = ray1.cross(ray2);
  const double n2 = n.squaredNorm();
  if (!(n2 > 0)) return 0;
  const Eigen::Vector3d d = point2 - point1;
  Yaw yaws[2];
  const int roots = SolveYaw(MakeYawEquation(n, d), yaws);
  // l1 = -(Rz D x x2) . n / |n|^2 = -Rz D . (x2 x n) / |n|^2, and the same with x1 for l2.
  const Eigen::Vector3d to_depth1 = ray2.cross(n) * (-1.0 / n2);
  const Eigen::Vector3d to_depth2 = ray1.cross(n) * (-1.0 / n2);
  int count = 0;
  for (int i = 0; i < roots; ++i) {
    const Eigen::Vector3d turned = TurnByYaw(yaws[i], d);
    const double depth1 = turned.dot(to_depth1);
    const double depth2 = turned.dot(to_depth2);
    if (!(depth1 > 0 && depth2 > 0)) continue;
    aligned_from_map[count++] = {yaws[i], depth1 * ray1 - TurnByYaw(yaws[i], point1)};
  }
  return count;
}

double Up2pConditioning(const Eigen::Vector3d& ray1, const Eigen::Vector3d& point1,
                        const Eigen::Vector3d& ray2, const Eigen::Vector3d& point2) {
  return YawConditioning(ray1.cross(ray2), point2 - point1);
}

int SolveUp2p(const Eigen::Vector3d& gravity_in_camera, const Eigen::Vector3d& ray1,
              const Eigen::Vector3d& point1, const Eigen::Vector3d& ray2,
              const Eigen::Vector3d& point2, Rigid3 camera_from_map[2]) {
  return SolveWithGravity(gravity_in_camera, camera_from_map,
                          [&](const auto& align, AlignedPose* out) {
                            return SolveUp2p(align(ray1), point1, align(ray2), point2, out);
                          });
}

}  // namespace maploc
