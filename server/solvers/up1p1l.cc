#include "server/solvers/up1p1l.h"

#include "server/solvers/yaw_equation.h"

namespace maploc {

int SolveUp1p1l(const Eigen::Vector3d& ray, const Eigen::Vector3d& point,
                const Eigen::Vector3d& plane_normal, const Eigen::Vector3d& line_point,
                const Eigen::Vector3d& line_direction, AlignedPose aligned_from_map[2]) {
  const double n_dot_x = plane_normal.dot(ray);
  if (n_dot_x == 0) return 0;
  Yaw yaws[2];
  const int roots = SolveYaw(MakeYawEquation(plane_normal, line_direction), yaws);
  const Eigen::Vector3d from_line = point - line_point;
  int count = 0;
  for (int i = 0; i < roots; ++i) {
    const double depth = plane_normal.dot(TurnByYaw(yaws[i], from_line)) / n_dot_x;
    if (!(depth > 0)) continue;
    aligned_from_map[count++] = {yaws[i], depth * ray - TurnByYaw(yaws[i], point)};
  }
  return count;
}

double Up1p1lConditioning(const Eigen::Vector3d& plane_normal,
                          const Eigen::Vector3d& line_direction) {
  return YawConditioning(plane_normal, line_direction);
}

int SolveUp1p1l(const Eigen::Vector3d& gravity_in_camera, const Eigen::Vector3d& ray,
                const Eigen::Vector3d& point, const Eigen::Vector3d& plane_normal,
                const Eigen::Vector3d& line_point, const Eigen::Vector3d& line_direction,
                Rigid3 camera_from_map[2]) {
  return SolveWithGravity(
      gravity_in_camera, camera_from_map, [&](const auto& align, AlignedPose* out) {
        return SolveUp1p1l(align(ray), point, align(plane_normal), line_point, line_direction, out);
      });
}

}  // namespace maploc
