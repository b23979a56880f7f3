#include "server/ransac/prepared_problem.h"

#include <numeric>
#include <utility>

#include "mapstore/geometry/gravity.h"

namespace maploc {
namespace {

Eigen::Vector3d Centroid(const PoseProblem& problem) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const PointCorrespondence& point : problem.points) sum += point.position_in_map;
  for (const LineCorrespondence& line : problem.lines) sum += line.segment_in_map.start;
  const std::size_t count = problem.points.size() + problem.lines.size();
  return count > 0 ? Eigen::Vector3d(sum / static_cast<double>(count)) : sum;
}

PoseProblem Centred(const PoseProblem& problem, const Eigen::Vector3d& centroid) {
  PoseProblem centred = problem;
  for (PointCorrespondence& point : centred.points) point.position_in_map -= centroid;
  for (LineCorrespondence& line : centred.lines) {
    line.segment_in_map.start -= centroid;
    line.segment_in_map.end -= centroid;
  }
  return centred;
}

PreparedLine PrepareLine(const LineCorrespondence& line,
                         const Eigen::Matrix3d& aligned_from_camera) {
  PreparedLine prepared;
  const Eigen::Vector3d normal =
      line.normalized.start.homogeneous().cross(line.normalized.end.homogeneous());
  const Eigen::Vector3d along = line.segment_in_map.end - line.segment_in_map.start;
  const bool seen = normal.squaredNorm() > 0 && along.squaredNorm() > 0;
  prepared.plane_normal_in_camera = seen ? Eigen::Vector3d(normal.normalized()) : normal;
  prepared.plane_normal_in_aligned = aligned_from_camera * prepared.plane_normal_in_camera;
  prepared.point = line.segment_in_map.start;
  prepared.direction = seen ? Eigen::Vector3d(along.normalized()) : along;
  prepared.usable = seen && IsUsableLine(line.segment_in_map);
  prepared.vertical = seen && !prepared.usable;
  return prepared;
}

void FillArrays(PreparedProblem* prepared, Random& random) {
  std::vector<std::uint32_t> order(prepared->centred.points.size());
  std::iota(order.begin(), order.end(), 0u);
  for (std::uint32_t i = static_cast<std::uint32_t>(order.size()); i > 1; --i) {
    std::swap(order[i - 1], order[random.Below(i)]);
  }
  prepared->place_in_arrays.resize(order.size());
  for (const std::uint32_t i : order) {
    prepared->place_in_arrays[i] = static_cast<std::uint32_t>(prepared->point_arrays.count);
    const PointCorrespondence& point = prepared->centred.points[i];
    const Eigen::Vector3f p = point.position_in_map.cast<float>();
    const Eigen::Vector2f seen = point.normalized.cast<float>();
    prepared->point_arrays.Add(p.x(), p.y(), p.z(), seen.x(), seen.y());
  }
  prepared->point_arrays.Pad();
  for (const LineCorrespondence& line : prepared->centred.lines) {
    const Eigen::Vector3f start = line.segment_in_map.start.cast<float>();
    const Eigen::Vector3f along =
        (line.segment_in_map.end - line.segment_in_map.start).cast<float>();
    Eigen::Vector4f seen;
    seen << line.normalized.start.cast<float>(), line.normalized.end.cast<float>();
    prepared->line_arrays.Add(start.data(), along.data(), seen.data());
  }
  prepared->line_arrays.Pad();
}

}  // namespace

PreparedProblem PrepareProblem(const PoseProblem& problem, Random& random) {
  PreparedProblem prepared;
  prepared.centroid = Centroid(problem);
  prepared.centred = Centred(problem, prepared.centroid);
  prepared.camera_from_aligned = problem.has_gravity ? CameraFromAligned(problem.gravity_in_camera)
                                                     : Eigen::Quaterniond::Identity();
  prepared.camera_from_aligned_matrix = prepared.camera_from_aligned.toRotationMatrix();
  const Eigen::Matrix3d aligned_from_camera = prepared.camera_from_aligned_matrix.transpose();
  for (const PointCorrespondence& point : prepared.centred.points) {
    const Eigen::Vector3d ray = point.normalized.homogeneous();
    prepared.points.push_back({ray, aligned_from_camera * ray, point.position_in_map});
  }
  for (const LineCorrespondence& line : prepared.centred.lines) {
    const std::int32_t index = static_cast<std::int32_t>(prepared.lines.size());
    prepared.lines.push_back(PrepareLine(line, aligned_from_camera));
    if (prepared.lines.back().usable) prepared.usable_lines.push_back(index);
    if (prepared.lines.back().vertical) prepared.vertical_lines.push_back(index);
  }
  FillArrays(&prepared, random);
  return prepared;
}

Rigid3 UncentredPose(const PreparedProblem& prepared, const PoseMatrix& camera_from_centred) {
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(camera_from_centred.rotation).normalized();
  return {rotation, camera_from_centred.translation - rotation * prepared.centroid};
}

ScoringPose ToScoringPose(const PoseMatrix& pose) {
  ScoringPose result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      result.rotation[3 * i + j] = static_cast<float>(pose.rotation(i, j));
    }
    result.translation[i] = static_cast<float>(pose.translation(i));
  }
  return result;
}

}  // namespace maploc
