#include "tests/support/synthetic_problem.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "mapstore/geometry/gravity.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kNearestPoint = 0.3;  // metres in front of the camera

Eigen::Vector3d RandomPointInMap(Scene scene, Random& random) {
  if (scene == Scene::kCube) {
    return {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
  }
  // Corridor along x, 3 m wide and high: on a wall, the floor or the ceiling.
  const double along = random.Uniform(-20, 20);
  const double across = random.Uniform(-1.5, 1.5);
  const double side = random.Below(2) == 0 ? -1.5 : 1.5;
  return random.Below(4) == 0 ? Eigen::Vector3d(along, across, side)
                              : Eigen::Vector3d(along, side, across);
}

LineSegment3 RandomSegmentInMap(Scene scene, bool vertical, Random& random) {
  LineSegment3 segment;
  segment.start = RandomPointInMap(scene, random);
  if (vertical) {
    const double up = segment.start.z() > 0 ? -1 : 1;
    segment.end = segment.start + Eigen::Vector3d(0, 0, up * random.Uniform(0.2, 1));
  } else if (scene == Scene::kCube) {
    segment.end = RandomPointInMap(scene, random);
  } else {
    const Eigen::Vector3d along(random.Uniform(-1, 1), 0, random.Uniform(-1, 1));
    segment.end = segment.start + along;
  }
  return segment;
}

class Maker {
 public:
  Maker(const SyntheticOptions& options, const Rigid3& camera_from_map, Random& random)
      : options_(options), camera_from_map_(camera_from_map), random_(random) {}

  PointCorrespondence Point(bool inlier) {
    PointCorrespondence point;
    do {
      point.position_in_map = RandomPointInMap(options_.scene, random_);
    } while (!IsVisible(point.position_in_map));
    point.normalized = SeesItself(inlier) ? Noisy(Project(point.position_in_map)) : RandomPixel();
    point.ratio = random_.Uniform(0.3, 1.0);
    return point;
  }

  LineCorrespondence Line(bool inlier) {
    LineCorrespondence line;
    const bool vertical = random_.Uniform() < options_.vertical_line_share;
    do {
      line.segment_in_map = RandomSegmentInMap(options_.scene, vertical, random_);
    } while (!IsVisible(line.segment_in_map.start) || !IsVisible(line.segment_in_map.end) ||
             ImageLength(line.segment_in_map) * options_.focal_length_px < 20.0);
    line.normalized = {Project(line.segment_in_map.start), Project(line.segment_in_map.end)};
    if (!SeesItself(inlier)) line.normalized = {RandomPixel(), RandomPixel()};
    line.normalized = {Noisy(line.normalized.start), Noisy(line.normalized.end)};
    line.ratio = random_.Uniform(0.3, 1.0);
    return line;
  }

 private:
  // A wrong association is made after, among features that each see themselves.
  bool SeesItself(bool inlier) const {
    return inlier || options_.outliers == Outliers::kWrongAssociations;
  }
  Eigen::Vector2d Project(const Eigen::Vector3d& point_in_map) const {
    return (camera_from_map_ * point_in_map).hnormalized();
  }
  double ImageLength(const LineSegment3& segment) const {
    return (Project(segment.start) - Project(segment.end)).norm();
  }
  bool IsVisible(const Eigen::Vector3d& point_in_map) const {
    const Eigen::Vector3d in_camera = camera_from_map_ * point_in_map;
    if (in_camera.z() < kNearestPoint) return false;
    const Eigen::Vector2d pixel = in_camera.hnormalized() * options_.focal_length_px;
    return std::abs(pixel.x()) < 0.5 * options_.image_width_px &&
           std::abs(pixel.y()) < 0.5 * options_.image_height_px;
  }
  Eigen::Vector2d RandomPixel() {
    return Eigen::Vector2d(random_.Uniform(-0.5, 0.5) * options_.image_width_px,
                           random_.Uniform(-0.5, 0.5) * options_.image_height_px) /
           options_.focal_length_px;
  }
  Eigen::Vector2d Noisy(const Eigen::Vector2d& normalized) {
    const double sigma = options_.noise_px / options_.focal_length_px;
    const double x = random_.Gaussian(sigma);
    const double y = random_.Gaussian(sigma);
    return normalized + Eigen::Vector2d(x, y);
  }

  const SyntheticOptions& options_;
  const Rigid3 camera_from_map_;
  Random& random_;
};

// The features from `begin` on exchange what they see along one random cycle (Sattolo's algorithm),
// so that none keeps its own. One alone sees `another`.
template <typename T>
void AssociateWrongly(std::vector<T>* features, int begin, const T& another, Random& random) {
  const std::uint32_t count = static_cast<std::uint32_t>(features->size()) - begin;
  if (count == 1) features->back().normalized = another.normalized;
  for (std::uint32_t i = count; i > 1; --i) {
    const std::uint32_t j = random.Below(i - 1);
    std::swap((*features)[begin + i - 1].normalized, (*features)[begin + j].normalized);
  }
}

template <typename T>
void Shuffle(std::vector<T>* features, std::vector<std::uint8_t>* flags, Random& random) {
  for (std::uint32_t i = static_cast<std::uint32_t>(features->size()); i > 1; --i) {
    const std::uint32_t j = random.Below(i);
    std::swap((*features)[i - 1], (*features)[j]);
    std::swap((*flags)[i - 1], (*flags)[j]);
  }
}

}  // namespace

Eigen::Vector3d RandomDirection(Random& random) {
  const double z = random.Uniform(-1, 1);
  const double angle = random.Uniform(0, 2 * std::numbers::pi);
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

Eigen::Quaterniond RandomRotation(Random& random) {
  Eigen::Vector4d q;
  for (int i = 0; i < 4; ++i) q(i) = random.Gaussian();
  q.normalize();
  return Eigen::Quaterniond(q(0), q(1), q(2), q(3));
}

SyntheticProblem MovedBy(const Eigen::Vector3d& by, SyntheticProblem problem) {
  for (auto& point : problem.problem.points) point.position_in_map += by;
  for (auto& line : problem.problem.lines) {
    line.segment_in_map.start += by;
    line.segment_in_map.end += by;
  }
  problem.camera_from_map.translation -= problem.camera_from_map.rotation * by;
  return problem;
}

Rigid3 MakeCameraFromMap(Scene scene, Random& random) {
  // Looking along `forward` with y down, then pitched and rolled.
  const double yaw = random.Uniform(-std::numbers::pi, std::numbers::pi);
  const double pitch = random.Uniform(-30, 30) * kDegree;
  const double roll = random.Uniform(-30, 30) * kDegree;
  Eigen::Matrix3d level_from_map;  // x right, y down, z forward for yaw 0 along x
  level_from_map << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
      Eigen::AngleAxisd(scene == Scene::kCube ? pitch : 0.3 * pitch, Eigen::Vector3d::UnitX())
          .toRotationMatrix() *
      level_from_map * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Eigen::Vector3d centre(random.Uniform(-5, 5), random.Uniform(-0.5, 0.5),
                         random.Uniform(-0.5, 0.5));
  if (scene == Scene::kCube) {
    const Eigen::Vector3d target(random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2),
                                 random.Uniform(-0.2, 0.2));
    centre = target - random.Uniform(3, 5) * rotation.row(2).transpose();
  }
  return {Eigen::Quaterniond(rotation).normalized(), -(rotation * centre)};
}

Eigen::Vector3d NoisyGravityInCamera(const Rigid3& camera_from_map, double sigma_rad,
                                     Random& random) {
  const double x = random.Gaussian(sigma_rad);
  const double y = random.Gaussian(sigma_rad);
  const Eigen::Vector3d tilt(x, y, 0);  // horizontal axes of the map
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(tilt.norm(), tilt.norm() > 0 ? Eigen::Vector3d(tilt.normalized())
                                                     : Eigen::Vector3d::UnitX()));
  return (camera_from_map.rotation * (turn * kGravityInMap)).normalized();
}

SyntheticProblem MakeSyntheticProblem(const SyntheticOptions& options, Random& random) {
  SyntheticProblem made;
  made.camera_from_map = MakeCameraFromMap(options.scene, random);
  Maker maker(options, made.camera_from_map, random);
  for (int i = 0; i < options.point_inliers + options.point_outliers; ++i) {
    made.point_is_inlier.push_back(i < options.point_inliers);
    made.problem.points.push_back(maker.Point(i < options.point_inliers));
  }
  for (int i = 0; i < options.line_inliers + options.line_outliers; ++i) {
    made.line_is_inlier.push_back(i < options.line_inliers);
    made.problem.lines.push_back(maker.Line(i < options.line_inliers));
  }
  if (options.outliers == Outliers::kWrongAssociations) {
    AssociateWrongly(&made.problem.points, options.point_inliers, maker.Point(true), random);
    AssociateWrongly(&made.problem.lines, options.line_inliers, maker.Line(true), random);
  }
  Shuffle(&made.problem.points, &made.point_is_inlier, random);
  Shuffle(&made.problem.lines, &made.line_is_inlier, random);
  made.problem.focal_length_px = options.focal_length_px;
  made.problem.gravity_in_camera =
      NoisyGravityInCamera(made.camera_from_map, options.gravity_noise_rad, random);
  made.problem.gravity_sigma_rad = options.gravity_sigma_rad;
  return made;
}

PoseError ComparePoses(const Rigid3& camera_from_map, const Rigid3& truth) {
  return {RotationAngleBetween(camera_from_map.rotation, truth.rotation),
          (camera_from_map.Inverse().translation - truth.Inverse().translation).norm()};
}

}  // namespace maploc::testing
