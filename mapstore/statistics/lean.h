// Is the map's gravity wrong? If one robot's gravity disagrees with the map, that robot's mounting
// is wrong. If the gravity of all robots disagrees in the same direction, the map's is. Pure
// functions.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace maploc {

// What one robot's queries say: the turns about the map's x and y axes that take the map's gravity
// to the measured one (Evidence::gravity_tilt_rad), of those queries that have one.
struct RobotTilts {
  std::string robot;
  std::vector<Eigen::Vector2d> tilts_rad;
};

struct Lean {
  // The mean of the robots' median tilts, and the angle within which the truth is in 95 of 100
  // cases.
  Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();
  double interval_rad = 0.0;
  std::int64_t robots = 0;   // that have enough queries: five
  std::int64_t queries = 0;  // theirs
  // Two robots or more; the lean is at least 1 degree, it is outside 1.75 of its intervals, and
  // every robot's tilt is closer to the mean than to zero.
  bool leans = false;
};

// A robot's queries share its mounting error. Robots are therefore counted, not queries: each robot
// has the same weight, however many queries it sent.
Lean FindLean(std::span<const RobotTilts> robots);

// Down in the map's frame according to the robots: the map's gravity, rotated by the tilt. The
// argument of `maploc-map level --gravity`.
Eigen::Vector3d GravityOfLean(const Eigen::Vector2d& tilt_rad);

}  // namespace maploc
