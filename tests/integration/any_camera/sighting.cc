#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mapstore/geometry/gravity.h"
#include "tests/integration/any_camera/place.h"

namespace maploc::testing {
namespace {

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

std::size_t WrongCount(const Choice& choice, const SightingOptions& options) {
  const double asked = options.wrong_a_true * static_cast<double>(choice.shown.size());
  return std::min(choice.hidden.size(), static_cast<std::size_t>(asked));
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
  choice.hidden.resize(WrongCount(choice, options));
  for (const int i : choice.hidden) add(AnyRay(options.reach_rad, random), i);
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
  choice.hidden.resize(WrongCount(choice, options));
  for (const int i : choice.hidden) {
    const Eigen::Vector3d start = AnyRay(options.reach_rad, random);
    Eigen::Vector3d end = start;
    do {
      end = Noisy(start, 8 * kRadPerDeg, random);
    } while (end.z() < least_z);
    add(start, end, i);
  }
}

// How every camera is mounted: away from the body's origin, and turned from its axes.
Rigid3 CameraFromBody(double unit_m) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, -1).normalized())),
          unit_m * Eigen::Vector3d(0.1, -0.2, 0.3)};
}

void Append(const BinaryDescriptor& descriptor, Descriptors& descriptors) {
  descriptors.bytes.insert(descriptors.bytes.end(), descriptor.begin(), descriptor.end());
}

}  // namespace

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
