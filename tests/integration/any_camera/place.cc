#include "tests/integration/any_camera/place.h"

#include <cmath>
#include <numbers>
#include <utility>

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

bool IsSeen(const Place& place, const Rigid3& camera_from_map, const Eigen::Vector3d& position) {
  return (camera_from_map * position).norm() < place.range_m;
}

// Turned by N(0, sigma) about two axes across it.
Eigen::Vector3d Noisy(const Eigen::Vector3d& ray, double sigma_rad, Random& random) {
  const Eigen::Vector3d across = ray.unitOrthogonal();
  const double first = random.Gaussian(sigma_rad);
  const double second = random.Gaussian(sigma_rad);
  return (ray + first * across + second * ray.cross(across)).normalized();
}

// Evenly over the cap of directions up to `reach_rad` off the axis.
Eigen::Vector3d AnyRay(double reach_rad, Random& random) {
  const double z = random.Uniform(std::cos(reach_rad), 1.0);
  const double around = random.Uniform(0, 2 * std::numbers::pi);
  const double across = std::sqrt(1 - z * z);
  return {across * std::cos(around), across * std::sin(around), z};
}

// In random order.
template <typename T>
void Shuffle(std::vector<T>& values, Random& random) {
  for (std::size_t i = values.size(); i > 1; --i) {
    std::swap(values[i - 1], values[random.Below(static_cast<std::uint32_t>(i))]);
  }
}

// The landmarks near by, those that the camera has in its reach first, at most `most` of them.
struct Choice {
  std::vector<int> shown;
  std::vector<int> hidden;  // what wrong features look like
};

template <typename IsInReach>
Choice Choose(std::vector<int> near, int most, const IsInReach& is_in_reach, Random& random) {
  Shuffle(near, random);
  Choice choice;
  for (const int index : near) {
    const bool is_shown = static_cast<int>(choice.shown.size()) < most && is_in_reach(index);
    (is_shown ? choice.shown : choice.hidden).push_back(index);
  }
  return choice;
}

constexpr double kFlip = 0.05;  // of a descriptor's bits

void SeePoints(const Place& place, const SightingOptions& options, Random& random,
               Sighting& sighting) {
  const auto ray_of = [&](int i) -> Eigen::Vector3d {
    return (sighting.camera_from_map * place.points[i].position).normalized();
  };
  std::vector<int> near;
  for (int i = 0; i < static_cast<int>(place.points.size()); ++i) {
    if (IsSeen(place, sighting.camera_from_map, place.points[i].position)) near.push_back(i);
  }
  const double least_z = std::cos(options.reach_rad);
  Choice choice = Choose(
      std::move(near), options.most_points, [&](int i) { return ray_of(i).z() > least_z; }, random);
  const auto add = [&](const Eigen::Vector3d& ray, int looks_like) {
    sighting.points.push_back({ray, Flipped(place.points[looks_like].descriptor, kFlip, random)});
  };
  for (const int i : choice.shown) add(Noisy(ray_of(i), options.noise_rad, random), i);
  const std::size_t wrong = std::min(
      choice.hidden.size(), static_cast<std::size_t>(options.wrong_a_true * choice.shown.size()));
  for (std::size_t i = 0; i < wrong; ++i) add(AnyRay(options.reach_rad, random), choice.hidden[i]);
}

void SeeLines(const Place& place, const SightingOptions& options, Random& random,
              Sighting& sighting) {
  const auto ray_of = [&](const Eigen::Vector3d& position) -> Eigen::Vector3d {
    return (sighting.camera_from_map * position).normalized();
  };
  std::vector<int> near;
  for (int i = 0; i < static_cast<int>(place.lines.size()); ++i) {
    if (IsSeen(place, sighting.camera_from_map, place.lines[i].segment.start)) near.push_back(i);
  }
  const double least_z = std::cos(options.reach_rad);
  const auto is_in_reach = [&](int i) {
    const LineSegment3& segment = place.lines[i].segment;
    return ray_of(segment.start).z() > least_z && ray_of(segment.end).z() > least_z &&
           AngleBetween(ray_of(segment.start), ray_of(segment.end)) > 3 * kRadPerDeg;
  };
  Choice choice = Choose(std::move(near), options.most_lines, is_in_reach, random);
  const auto add = [&](const Eigen::Vector3d& start, const Eigen::Vector3d& end, int looks_like) {
    sighting.lines.push_back(
        {start, end, Flipped(place.lines[looks_like].descriptor, kFlip, random)});
  };
  for (const int i : choice.shown) {
    const LineSegment3& segment = place.lines[i].segment;
    const Eigen::Vector3d start = Noisy(ray_of(segment.start), options.noise_rad, random);
    add(start, Noisy(ray_of(segment.end), options.noise_rad, random), i);
  }
  const std::size_t wrong = std::min(
      choice.hidden.size(), static_cast<std::size_t>(options.wrong_a_true * choice.shown.size()));
  for (std::size_t i = 0; i < wrong; ++i) {
    const Eigen::Vector3d start = AnyRay(options.reach_rad, random);
    Eigen::Vector3d end = start;
    do {
      end = Noisy(start, 8 * kRadPerDeg, random);
    } while (end.z() < least_z);
    add(start, end, choice.hidden[i]);
  }
}

// How every camera is mounted: away from the body's origin, and turned from its axes.
Rigid3 CameraFromBody(double unit_m) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, -1).normalized())),
          unit_m * Eigen::Vector3d(0.1, -0.2, 0.3)};
}

bool IsInImage(const Camera& lens, const Eigen::Vector2d& pixel) {
  return pixel.minCoeff() >= 0 && pixel.x() <= lens.width_px() - 1 &&
         pixel.y() <= lens.height_px() - 1;
}

void Append(const BinaryDescriptor& descriptor, Descriptors& descriptors) {
  descriptors.bytes.insert(descriptors.bytes.end(), descriptor.begin(), descriptor.end());
}

}  // namespace

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

Sighting See(const Place& place, const Rigid3& camera_from_map, const SightingOptions& options,
             Random& random) {
  Sighting sighting{camera_from_map, CameraFromBody(place.unit_m), {}, {}, {}};
  SeePoints(place, options, random, sighting);
  SeeLines(place, options, random, sighting);
  const Eigen::Vector3d gravity = GravityInCamera(camera_from_map.rotation);
  sighting.gravity = {Noisy(gravity, options.gravity_noise_rad, random), options.gravity_noise_rad};
  return sighting;
}

Query Through(const Sighting& sighting, const Camera& lens, const Eigen::Quaterniond& turn) {
  View view{lens, Rigid3{turn, Eigen::Vector3d::Zero()} * sighting.camera_from_body, {}, {}};
  view.points.descriptors.kind = *DescriptorKindFromName("orb");
  view.lines.descriptors.kind = *DescriptorKindFromName("lbd");
  for (const Sighting::Point& point : sighting.points) {
    const auto pixel = lens.Project(turn * point.ray);
    if (!pixel || !IsInImage(lens, *pixel)) continue;
    view.points.keypoints_px.push_back(pixel->cast<float>());
    Append(point.shown, view.points.descriptors);
  }
  for (const Sighting::Line& line : sighting.lines) {
    const auto start = lens.Project(turn * line.start);
    const auto end = lens.Project(turn * line.end);
    if (!start || !end || !IsInImage(lens, *start) || !IsInImage(lens, *end)) continue;
    view.lines.starts_px.push_back(start->cast<float>());
    view.lines.ends_px.push_back(end->cast<float>());
    Append(line.shown, view.lines.descriptors);
  }
  Query query;
  query.views.push_back(std::move(view));
  query.gravity = sighting.gravity;
  query.gravity->direction_in_body =
      sighting.camera_from_body.rotation.conjugate() * sighting.gravity.direction_in_body;
  return query;
}

}  // namespace maploc::testing
