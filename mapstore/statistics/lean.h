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

struct LeanOptions {
  // Fewer queries of a robot do not count: one pose may be wrong.
  std::int64_t min_queries = 5;
  // A single robot may be mounted askew, so this many robots are needed.
  std::int64_t min_robots = 2;
  // Standard deviation of the robots' independent mounting errors. The scatter of few robots is not
  // taken to be below it and what their queries' scatter leaves in their medians.
  double robot_sigma_rad = 0.0087;  // 0.5 degrees
  // A smaller lean is ignored, however certain.
  double min_lean_rad = 0.0175;  // 1 degree
};

struct Lean {
  // The mean of the robots' median tilts, and the angle within which the truth is in 95 of 100
  // cases.
  Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();
  double interval_rad = 0.0;
  std::int64_t robots = 0;   // that have enough queries
  std::int64_t queries = 0;  // theirs
  // Enough robots; the lean is at least min_lean_rad, it is outside 1.75 of its intervals, and
  // every robot's tilt is closer to the mean than to zero.
  bool leans = false;
};

// A robot's queries share its mounting error. Robots are therefore counted, not queries: each robot
// has the same weight, however many queries it sent.
Lean FindLean(std::span<const RobotTilts> robots, const LeanOptions& options = {});

// Down in the map's frame according to the robots: the map's gravity, rotated by the tilt. The
// argument of `maploc-map level --gravity`.
Eigen::Vector3d GravityOfLean(const Eigen::Vector2d& tilt_rad);

}  // namespace maploc
