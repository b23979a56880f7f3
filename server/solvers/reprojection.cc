#include "server/solvers/reprojection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace maploc {
namespace {

bool FrameReprojection(const PixelFrame& frame, const Eigen::Vector3d& rotated,
                       const Eigen::Vector3d& q, Eigen::Vector2d* error, Jacobian26* jacobian) {
  const double depth = frame.ray.dot(q);
  if (depth <= 0) return false;
  *error = frame.across * q / depth;
  if (jacobian == nullptr) return true;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d by_q = (frame.across.row(i).transpose() - (*error)(i)*frame.ray) / depth;
    jacobian->row(i).leftCols<3>() = rotated.cross(by_q).transpose();
    jacobian->row(i).rightCols<3>() = by_q.transpose();
  }
  return true;
}

// A line under a pose, from `start` along `direction` in the camera's frame.
struct LineInCamera {
  Eigen::Vector3d rotated_start;  // R s
  Eigen::Vector3d start;
  Eigen::Vector3d direction;
  Eigen::Vector3d moment;  // start x direction

  LineInCamera(const PoseMatrix& pose, const LineSegment3& segment)
      : rotated_start(pose.rotation * segment.start),
        start(rotated_start + pose.translation),
        direction(pose.rotation * (segment.end - segment.start)),
        moment(start.cross(direction)) {}

  // Some of it lies on the side that `axis` points to.
  bool IsInFront(const Eigen::Vector3d& axis) const {
    const double depth = axis.dot(start);
    return std::max(depth, depth + axis.dot(direction)) > 0;
  }
};

// The direction that a line is seen in: the camera's, or the seen segment's own.
Eigen::Vector3d Axis(const LineCorrespondence& line) {
  if (!line.frames) return Eigen::Vector3d::UnitZ();
  return (*line.frames)[0].ray + (*line.frames)[1].ray;
}

// The derivative of e = m . ray / |P m| by (w, d), by way of m; see LineReprojection.
void FillEnd(const LineInCamera& line, const Eigen::Vector3d& translation,
             const Eigen::Vector3d& by_moment, int row, Jacobian26* jacobian) {
  const Eigen::Vector3d turning = line.rotated_start.cross(line.direction);
  jacobian->row(row).leftCols<3>() =
      (turning.cross(by_moment) + line.direction.cross(by_moment.cross(translation))).transpose();
  jacobian->row(row).rightCols<3>() = line.direction.cross(by_moment).transpose();
}

bool FrameReprojection(const PoseMatrix& pose, const LineCorrespondence& line,
                       Eigen::Vector2d* error, Jacobian26* jacobian) {
  const LineInCamera in_camera(pose, line.segment_in_map);
  if (!in_camera.IsInFront(Axis(line))) return false;
  for (int i = 0; i < 2; ++i) {
    const PixelFrame& frame = (*line.frames)[static_cast<std::size_t>(i)];
    const Eigen::Matrix<double, 2, 3> gradient = frame.Gradient();
    const Eigen::Vector2d in_image = gradient * in_camera.moment;
    const double norm = in_image.norm();
    if (!(norm > 0)) return false;
    const double e = in_camera.moment.dot(frame.ray) / norm;
    (*error)(i) = e;
    if (jacobian == nullptr) continue;
    const Eigen::Vector3d by_moment =
        (frame.ray - e / norm * (gradient.transpose() * in_image)) / norm;
    FillEnd(in_camera, pose.translation, by_moment, i, jacobian);
  }
  return true;
}

}  // namespace

bool PointReprojection(const PoseMatrix& camera_from_map, const PointCorrespondence& point,
                       Eigen::Vector2d* error, Jacobian26* jacobian) {
  const Eigen::Vector3d rotated = camera_from_map.rotation * point.position_in_map;
  const Eigen::Vector3d q = rotated + camera_from_map.translation;
  if (point.frame) return FrameReprojection(*point.frame, rotated, q, error, jacobian);
  if (q.z() <= 0) return false;
  const double inverse_depth = 1.0 / q.z();
  const double x = q.x() * inverse_depth;
  const double y = q.y() * inverse_depth;
  *error = Eigen::Vector2d(x, y) - point.normalized;
  if (jacobian != nullptr) {
    const Eigen::Vector3d by_q[2] = {{inverse_depth, 0, -x * inverse_depth},
                                     {0, inverse_depth, -y * inverse_depth}};
    for (int i = 0; i < 2; ++i) {
      // dq/dw = -[R p]x, so e's row a becomes -a^T [R p]x = (R p x a)^T.
      jacobian->row(i).leftCols<3>() = rotated.cross(by_q[i]).transpose();
      jacobian->row(i).rightCols<3>() = by_q[i].transpose();
    }
  }
  return true;
}

bool LineReprojection(const PoseMatrix& camera_from_map, const LineCorrespondence& line,
                      Eigen::Vector2d* error, Jacobian26* jacobian) {
  if (line.frames) return FrameReprojection(camera_from_map, line, error, jacobian);
  const Eigen::Vector3d rotated = camera_from_map.rotation * line.segment_in_map.start;
  const Eigen::Vector3d direction =
      camera_from_map.rotation * (line.segment_in_map.end - line.segment_in_map.start);
  const Eigen::Vector3d start = rotated + camera_from_map.translation;
  if (std::max(start.z(), start.z() + direction.z()) <= 0) return false;
  const Eigen::Vector3d moment = start.cross(direction);
  const double norm = moment.head<2>().norm();
  if (!(norm > 0)) return false;
  const Eigen::Vector3d seen[2] = {line.normalized.start.homogeneous(),
                                   line.normalized.end.homogeneous()};
  for (int i = 0; i < 2; ++i) (*error)(i) = moment.dot(seen[i]) / norm;
  if (jacobian == nullptr) return true;
  // m = R s x D + t x D with D = R (end - s): dm/dw = -[R s x D]x - [t]x [D]x, dm/dd = -[D]x, and
  // -a^T [v]x = (v x a)^T.
  const Eigen::Vector3d turning = rotated.cross(direction);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d by_moment =
        (seen[i] - (*error)(i) / norm * Eigen::Vector3d(moment.x(), moment.y(), 0)) / norm;
    jacobian->row(i).leftCols<3>() =
        (turning.cross(by_moment) + direction.cross(by_moment.cross(camera_from_map.translation)))
            .transpose();
    jacobian->row(i).rightCols<3>() = direction.cross(by_moment).transpose();
  }
  return true;
}

double ProjectedLength(const PoseMatrix& camera_from_map, const LineCorrespondence& line) {
  const LineInCamera in_camera(camera_from_map, line.segment_in_map);
  if (!in_camera.IsInFront(Axis(line))) return 0.0;
  const Eigen::Vector3d& a = in_camera.start;
  const Eigen::Vector3d b = a + in_camera.direction;
  if (line.frames) {
    if (a.dot(b) <= 0) return std::numeric_limits<double>::infinity();
    const double scale = 0.5 * ((*line.frames)[0].Scale() + (*line.frames)[1].Scale());
    return scale * in_camera.moment.norm() / (a.norm() * b.norm());
  }
  if (a.z() <= 0 || b.z() <= 0) return std::numeric_limits<double>::infinity();
  return (a.head<2>() / a.z() - b.head<2>() / b.z()).norm();
}

double SeenDepth(const PoseMatrix& camera_from_map, const PointCorrespondence& point) {
  const Eigen::Vector3d q =
      camera_from_map.rotation * point.position_in_map + camera_from_map.translation;
  return point.frame ? point.frame->ray.dot(q) : q.z();
}

double SeenDepth(const PoseMatrix& camera_from_map, const LineCorrespondence& line) {
  const LineInCamera in_camera(camera_from_map, line.segment_in_map);
  const Eigen::Vector3d axis = Axis(line).normalized();
  const double start = axis.dot(in_camera.start);
  const double end = start + axis.dot(in_camera.direction);
  return 0.5 * (std::max(start, 0.0) + std::max(end, 0.0));
}

bool IsPointInlier(const PoseMatrix& camera_from_map, const PointCorrespondence& point,
                   double threshold) {
  Eigen::Vector2d error;
  return PointReprojection(camera_from_map, point, &error, nullptr) &&
         error.squaredNorm() < threshold * threshold;
}

bool IsLineInlier(const PoseMatrix& camera_from_map, const LineCorrespondence& line,
                  double threshold, double min_length) {
  Eigen::Vector2d error;
  return LineReprojection(camera_from_map, line, &error, nullptr) &&
         error.cwiseAbs().maxCoeff() < threshold &&
         ProjectedLength(camera_from_map, line) >= min_length;
}

PoseProblem MovedTo(const PoseProblem& problem, const Eigen::Vector3d& origin_in_map) {
  PoseProblem moved = problem;
  for (PointCorrespondence& point : moved.points) point.position_in_map -= origin_in_map;
  for (LineCorrespondence& line : moved.lines) {
    line.segment_in_map.start -= origin_in_map;
    line.segment_in_map.end -= origin_in_map;
  }
  return moved;
}

InlierFlags FindInliers(const PoseProblem& problem, const Rigid3& camera_from_map,
                        double threshold_px) {
  const PoseMatrix pose(camera_from_map);
  const double threshold = threshold_px / problem.focal_length_px;
  const double min_length = kMinProjectedLinePx / problem.focal_length_px;
  InlierFlags flags;
  flags.points.reserve(problem.points.size());
  flags.lines.reserve(problem.lines.size());
  for (const PointCorrespondence& point : problem.points) {
    flags.points.push_back(IsPointInlier(pose, point, threshold) ? 1 : 0);
    flags.count += flags.points.back();
  }
  for (const LineCorrespondence& line : problem.lines) {
    flags.lines.push_back(IsLineInlier(pose, line, threshold, min_length) ? 1 : 0);
    flags.count += flags.lines.back();
  }
  return flags;
}

}  // namespace maploc
