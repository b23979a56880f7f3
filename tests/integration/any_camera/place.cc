#include "tests/integration/any_camera/place.h"

#include <cmath>

#include "mapstore/geometry/gravity.h"

namespace maploc::testing {
namespace {

constexpr int kRooms = 4;
constexpr double kRoomPitch = 20.0;
constexpr int kLandmarksARoom = 900;  // of each kind
constexpr int kLandmarksOfField = 1000;

Eigen::Vector3d Direction(Random& random) {
  return Eigen::Vector3d(random.Gaussian(), random.Gaussian(), random.Gaussian()).normalized();
}

// A third of the lines stand upright, a third lie level.
Eigen::Vector3d AlongLine(Random& random) {
  const std::uint32_t kind = random.Below(3);
  if (kind == 0) return Eigen::Vector3d::UnitZ();
  Eigen::Vector3d along = Direction(random);
  if (kind == 1) along.z() = 0.0;
  return along.normalized();
}

void AddPoint(Place& place, const Eigen::Vector3d& position, Random& random) {
  place.points.push_back({position, RandomDescriptor(random)});
}

void AddLine(Place& place, const Eigen::Vector3d& start, double length_m, Random& random) {
  place.lines.push_back({{start, start + length_m * AlongLine(random)}, RandomDescriptor(random)});
}

void AddRoom(Place& place, const Eigen::Vector3d& middle, Random& random) {
  const double unit_m = place.unit_m;
  const auto anywhere = [&]() -> Eigen::Vector3d {
    return middle + unit_m * random.Uniform(3.0, 5.0) * Direction(random);
  };
  for (int i = 0; i < kLandmarksARoom; ++i) AddPoint(place, anywhere(), random);
  for (int i = 0; i < kLandmarksARoom; ++i) AddLine(place, anywhere(), 0.8 * unit_m, random);
  for (const double aside : {-0.5, 0.0, 0.5}) {
    place.spots.push_back(middle +
                          unit_m * Eigen::Vector3d(0.8 * aside, aside * aside, 0.4 * aside));
    for (int direction = 0; direction < 24; ++direction) {
      const double pitch_rad = (direction % 3 - 1) * 50 * kRadPerDeg;
      const Eigen::Vector3d gravity(0, std::cos(pitch_rad), std::sin(pitch_rad));
      place.camera_from_map.push_back(
          CameraFromMap(place.spots.back(), gravity, direction / 3 * 45 * kRadPerDeg));
    }
  }
}

}  // namespace

bool IsInImage(const Camera& lens, const Eigen::Vector2d& pixel) {
  return pixel.minCoeff() >= 0 && pixel.x() <= lens.width_px() - 1 &&
         pixel.y() <= lens.height_px() - 1;
}

Rigid3 CameraFromMap(const Eigen::Vector3d& centre, const Eigen::Vector3d& gravity_in_camera,
                     double yaw_rad) {
  const Eigen::Quaterniond rotation =
      CameraFromAligned(gravity_in_camera.normalized()) *
      Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  return {rotation, -(rotation * centre)};
}

Place MakeRooms(double unit_m, const Eigen::Vector3d& origin, Random& random) {
  Place place;
  place.unit_m = unit_m;
  place.range_m = 8.0 * unit_m;
  for (int room = 0; room < kRooms; ++room) {
    AddRoom(place, origin + room * kRoomPitch * unit_m * Eigen::Vector3d::UnitX(), random);
  }
  return place;
}

Place MakeField(Random& random) {
  Place place;
  place.range_m = 25.0;
  const auto anywhere = [&]() -> Eigen::Vector3d {
    return {random.Uniform(0, 80), random.Uniform(-20, 20),
            random.Below(4) == 0 ? random.Uniform(0, 4) : 0.0};
  };
  for (int i = 0; i < kLandmarksOfField; ++i) AddPoint(place, anywhere(), random);
  for (int i = 0; i < kLandmarksOfField; ++i) AddLine(place, anywhere(), 2.5, random);
  for (double x = 5; x <= 75; x += 2.5) {
    for (const double y : {-10.0, 0.0, 10.0}) {
      place.spots.emplace_back(x, y, 15.0 + 0.05 * y);
      place.camera_from_map.push_back(
          CameraFromMap(place.spots.back(), Eigen::Vector3d::UnitZ(), 0.0));
    }
  }
  return place;
}

}  // namespace maploc::testing
