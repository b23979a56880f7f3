#include "client/robot/simulated_robot.h"

#include <cmath>
#include <cstdio>

#include "client/robot/gravity_source.h"
#include "mapstore/base/angles.h"

namespace maploc {
namespace {

constexpr double kCameraYawRad = -40.0 * kRadPerDeg;  // to the right
const Eigen::Vector3d kCameraInBody(0.2, 0.0, 1.2);

// How a drive wanders: standard deviations.
constexpr double kAsideM = 0.3;
constexpr double kTurnRad = 6.0 * kRadPerDeg;
constexpr double kTiltRad = 1.5 * kRadPerDeg;

}  // namespace

Rigid3 SimulatedCameraFromBody() {
  const Eigen::Vector3d forward(std::cos(kCameraYawRad), std::sin(kCameraYawRad), 0.0);
  const Eigen::Vector3d down(0.0, 0.0, -1.0);
  Eigen::Matrix3d camera_from_body;
  // Rows are the camera's axes in the body's frame: x right, y down, z forward.
  camera_from_body << down.cross(forward).transpose(), down.transpose(), forward.transpose();
  return {Eigen::Quaterniond(camera_from_body), -(camera_from_body * kCameraInBody)};
}

Rigid3 WorldFromBody(const World& world, double along_m, double aside_m, double turn_rad,
                     double roll_rad, double pitch_rad) {
  const double heading = world.HeadingAt(along_m) + turn_rad;
  const Eigen::Quaterniond rotation = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX());
  return {rotation, world.PointAt(along_m, aside_m, 0.0)};
}

SimulatedRobot::SimulatedRobot(const World& world, const DriveOptions& options, const MapInfo& map)
    : world_(world), options_(options), map_(map) {
  // Drawn once: a query and its reference are of one pose.
  Random random(options.seed);
  for (int i = 0; i < options.queries; ++i) {
    const double along_m = options.start_m + i * world.LaneLength() / options.queries;
    world_from_body_.push_back(WorldFromBody(
        world, along_m, options.aside_m + random.Gaussian(kAsideM), random.Gaussian(kTurnRad),
        random.Gaussian(kTiltRad), random.Gaussian(kTiltRad)));
  }
}

std::string SimulatedRobot::QueryName(int index) const {
  char number[16];
  std::snprintf(number, sizeof(number), "/%04d", index);
  return (options_.name.empty() ? std::string(SeasonName(options_.season)) : options_.name) +
         number;
}

Rigid3 SimulatedRobot::ReferenceMapFromBody(int index) const {
  return MovePose(map_.map_from_source, world_from_body_[index].Inverse()).Inverse();
}

Result<Query> SimulatedRobot::MakeQuery(int index) const {
  // A generator of the query's own: it is the same query however many were asked before.
  Random random = Random(options_.seed).Fork(static_cast<std::uint64_t>(index));
  const Rigid3 camera_from_body = SimulatedCameraFromBody();
  const Rigid3 camera_from_world = camera_from_body * world_from_body_[index].Inverse();
  const Appearance appearance = options_.appearance.value_or(AppearanceOf(options_.season));
  Sight sight = Look(world_, camera_, camera_from_world, appearance, options_.sight, random);
  View view{camera_, camera_from_body, std::move(sight.points), std::move(sight.lines)};
  if (map_.line_descriptor.name.empty()) view.lines = {};

  Query query;
  query.request_id = QueryName(index);
  query.map = map_.key.name;
  query.views.push_back(std::move(view));
  const double noise_rad = options_.gravity_noise_deg * kRadPerDeg;
  const Rigid3 body_from_map = ReferenceMapFromBody(index).Inverse();
  query.gravity = Gravity{NoisyGravityInCamera(body_from_map.rotation, noise_rad, random),
                          std::max(noise_rad, kMinGravitySigmaDeg * kRadPerDeg)};
  return query;
}

}  // namespace maploc
