// Does the map lean? One robot's gravity that disagrees with the map is that robot's mounting; the
// gravity of all robots that disagrees the same way is the map's. Pure functions.
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
  // One robot may be mounted askew; from this many on they agree or they do not.
  std::int64_t min_robots = 2;
  // Robots are mounted askew by so much, each its own way (one standard deviation): what the
  // scatter of few robots is not believed to be below.
  double robot_sigma_rad = 0.0087;  // 0.5 degrees
  // A smaller lean is nobody's concern, however certain.
  double min_lean_rad = 0.0175;  // 1 degree
};

struct Lean {
  // The mean of the robots' median tilts, and the angle within which the truth is in 95 of 100
  // cases.
  Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();
  double interval_rad = 0.0;
  std::int64_t robots = 0;   // that have enough queries
  std::int64_t queries = 0;  // theirs
  // Enough robots; the lean is of concern, is outside 1.75 of its intervals, and every robot's tilt
  // is nearer to the mean than to none.
  bool leans = false;
};

// A robot's queries share its mounting's error, so that robots are what is counted; a robot has one
// voice, however much it drove.
Lean FindLean(std::span<const RobotTilts> robots, const LeanOptions& options = {});

// Down in the map's frame as the robots have it: the map's gravity, turned by the tilt. What
// `maploc-map level --gravity` takes.
Eigen::Vector3d GravityOfLean(const Eigen::Vector2d& tilt_rad);

}  // namespace maploc
