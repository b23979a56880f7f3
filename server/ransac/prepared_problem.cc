#include "server/ransac/prepared_problem.h"

#include <algorithm>
#include <array>
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

PreparedLine PrepareLine(const LineCorrespondence& line,
                         const Eigen::Matrix3d& aligned_from_camera) {
  PreparedLine prepared;
  const Eigen::Vector3d normal =
      line.frames ? (*line.frames)[0].ray.cross((*line.frames)[1].ray)
                  : Eigen::Vector3d(line.normalized.start.homogeneous())
                        .cross(Eigen::Vector3d(line.normalized.end.homogeneous()));
  const Eigen::Vector3d along = line.segment_in_map.end - line.segment_in_map.start;
  // A segment along one ray, or a landmark of no length, has no plane or no direction. Such a line
  // is neither usable nor vertical, and is never drawn.
  const bool seen = normal.squaredNorm() > 0 && along.squaredNorm() > 0;
  prepared.plane_normal_in_camera = seen ? Eigen::Vector3d(normal.normalized()) : normal;
  prepared.plane_normal_in_aligned = aligned_from_camera * prepared.plane_normal_in_camera;
  prepared.point = line.segment_in_map.start;
  prepared.direction = seen ? Eigen::Vector3d(along.normalized()) : along;
  prepared.usable = seen && IsUsableLine(line.segment_in_map);
  prepared.vertical = seen && !prepared.usable;
  return prepared;
}

std::vector<std::uint32_t> RandomOrder(std::size_t count, Random& random) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::uint32_t i = static_cast<std::uint32_t>(order.size()); i > 1; --i) {
    std::swap(order[i - 1], order[random.Below(i)]);
  }
  return order;
}

Places MakePlaces(std::vector<std::uint32_t> feature_at) {
  Places places;
  places.of_feature.resize(feature_at.size());
  for (std::uint32_t place = 0; place < feature_at.size(); ++place) {
    places.of_feature[feature_at[place]] = place;
  }
  places.feature_at = std::move(feature_at);
  return places;
}

void FillPointArrays(PreparedProblem* prepared) {
  for (const std::uint32_t i : prepared->point_places.feature_at) {
    const PointCorrespondence& point = prepared->centred.points[i];
    const Eigen::Vector3f position = point.position_in_map.cast<float>();
    if (point.frame) {
      Eigen::Matrix<float, 3, 3, Eigen::RowMajor> frame;
      frame << point.frame->ray.transpose().cast<float>(), point.frame->across.cast<float>();
      prepared->point_arrays.Add(position.data(), frame.data());
    } else {
      const Eigen::Vector2f seen = point.normalized.cast<float>();
      prepared->point_arrays.Add(position.data(), seen.x(), seen.y());
    }
  }
  prepared->point_arrays.Pad();
}

void AddFramedLine(const std::array<PixelFrame, 2>& frames, const Eigen::Vector3f& start,
                   const Eigen::Vector3f& along, LineArrays* arrays) {
  Eigen::Matrix<float, 6, 3, Eigen::RowMajor> ends;
  ends << frames[0].ray.transpose().cast<float>(), frames[0].Gradient().cast<float>(),
      frames[1].ray.transpose().cast<float>(), frames[1].Gradient().cast<float>();
  const double scale = 0.5 * (frames[0].Scale() + frames[1].Scale());
  arrays->Add(start.data(), along.data(), ends.data(), static_cast<float>(scale));
}

void FillLineArrays(PreparedProblem* prepared) {
  for (const std::uint32_t i : prepared->line_places.feature_at) {
    const LineCorrespondence& line = prepared->centred.lines[i];
    const Eigen::Vector3f start = line.segment_in_map.start.cast<float>();
    const Eigen::Vector3f along =
        (line.segment_in_map.end - line.segment_in_map.start).cast<float>();
    if (line.frames) {
      AddFramedLine(*line.frames, start, along, &prepared->line_arrays);
    } else {
      Eigen::Vector4f seen;
      seen << line.normalized.start.cast<float>(), line.normalized.end.cast<float>();
      prepared->line_arrays.Add(start.data(), along.data(), seen.data());
    }
  }
  prepared->line_arrays.Pad();
}

// The surest first, to 1/256 of a ratio: a counting sort, which keeps the random order of equals.
template <typename Correspondence>
std::vector<std::uint32_t> SortedByQuality(const std::vector<Correspondence>& features,
                                           const std::vector<std::uint32_t>& indices) {
  constexpr int kBuckets = 256;
  const auto bucket_of = [&](std::uint32_t index) {
    return static_cast<std::size_t>(std::clamp(features[index].ratio, 0.0, 1.0) * (kBuckets - 1));
  };
  std::array<std::uint32_t, kBuckets + 1> begins{};
  for (const std::uint32_t index : indices) ++begins[bucket_of(index) + 1];
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  std::vector<std::uint32_t> sorted(indices.size());
  for (const std::uint32_t index : indices) sorted[begins[bucket_of(index)]++] = index;
  return sorted;
}

template <typename Correspondence>
bool RatiosDiffer(const std::vector<Correspondence>& features) {
  return std::any_of(features.begin(), features.end(), [&](const Correspondence& feature) {
    return feature.ratio != features.front().ratio;
  });
}

void OrderForDrawing(PreparedProblem* prepared, Random& random) {
  const PoseProblem& problem = prepared->centred;
  prepared->has_quality = RatiosDiffer(problem.points) || RatiosDiffer(problem.lines);
  std::vector<std::uint32_t> usable;
  std::vector<std::uint32_t> vertical;
  for (const std::uint32_t i : RandomOrder(problem.lines.size(), random)) {
    if (prepared->lines[i].usable) usable.push_back(i);
    if (prepared->lines[i].vertical) vertical.push_back(i);
  }
  prepared->drawn_points =
      SortedByQuality(problem.points, RandomOrder(problem.points.size(), random));
  prepared->usable_lines = SortedByQuality(problem.lines, usable);
  prepared->vertical_lines = SortedByQuality(problem.lines, vertical);
}

}  // namespace

PreparedProblem PrepareProblem(const PoseProblem& problem, Random& random) {
  PreparedProblem prepared;
  prepared.centroid = Centroid(problem);
  prepared.centred = MovedTo(problem, prepared.centroid);
  // Without gravity only P3P is drawn, which takes the rays of the camera.
  const Eigen::Quaterniond camera_from_aligned = problem.has_gravity
                                                     ? CameraFromAligned(problem.gravity_in_camera)
                                                     : Eigen::Quaterniond::Identity();
  prepared.camera_from_aligned_matrix = camera_from_aligned.toRotationMatrix();
  const Eigen::Matrix3d aligned_from_camera = prepared.camera_from_aligned_matrix.transpose();
  prepared.points.reserve(prepared.centred.points.size());
  for (const PointCorrespondence& point : prepared.centred.points) {
    const Eigen::Vector3d ray =
        point.frame ? point.frame->ray : Eigen::Vector3d(point.normalized.homogeneous());
    prepared.points.push_back({ray, aligned_from_camera * ray, point.position_in_map,
                               point.frame ? point.frame->Scale() : 0.0});
  }
  prepared.lines.reserve(prepared.centred.lines.size());
  for (const LineCorrespondence& line : prepared.centred.lines) {
    prepared.lines.push_back(PrepareLine(line, aligned_from_camera));
  }
  prepared.point_places = MakePlaces(RandomOrder(prepared.points.size(), random));
  prepared.line_places = MakePlaces(RandomOrder(prepared.lines.size(), random));
  FillPointArrays(&prepared);
  FillLineArrays(&prepared);
  OrderForDrawing(&prepared, random);
  return prepared;
}

Rigid3 UncentredPose(const PreparedProblem& prepared, const PoseMatrix& camera_from_centred) {
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(camera_from_centred.rotation).normalized();
  return {rotation, camera_from_centred.translation - rotation * prepared.centroid};
}

PoseMatrix CameraFromCentred(const PreparedProblem& prepared,
                             const AlignedPose& aligned_from_centred) {
  const Eigen::Matrix3d& turn = prepared.camera_from_aligned_matrix;
  PoseMatrix pose;
  pose.rotation.noalias() = turn * RotationMatrix(aligned_from_centred.yaw);
  pose.translation.noalias() = turn * aligned_from_centred.translation;
  return pose;
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
