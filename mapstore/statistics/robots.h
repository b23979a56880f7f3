// Separates faults of a robot from changes of the map: each robot is compared with the others that
// drove through the same segments at about the same time. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mapstore/model/session.h"

namespace maploc {

// In which a robot may stand out, always for the worse.
enum class RobotMetric {
  kGravity = 1,  // disagreement of measured gravity and pose (rad): its IMU, or its mounting
  kPoints = 2,   // inlier ratio of points: camera, calibration, descriptors
  kLines = 3,    // inlier ratio of all lines
  kSuccess = 4,  // share of localized queries
};
inline constexpr std::array kRobotMetrics = {RobotMetric::kGravity, RobotMetric::kPoints,
                                             RobotMetric::kLines, RobotMetric::kSuccess};
std::string_view RobotMetricName(RobotMetric metric);  // "gravity", "points", "lines", "success"

struct RobotSession {
  SessionId session;
  std::string robot;
  std::int64_t start_unix_ns = 0;
  std::span<const Observation> observations;  // the caller's, alive while robots are compared
};

// How a robot, or a session, differs from the others in one metric.
struct RobotDifference {
  RobotMetric metric = RobotMetric::kGravity;
  double own = 0.0;        // median over the segments it saw
  double others = 0.0;     // median of what the others saw there
  double deviation = 0.0;  // standard deviations for the worse; negative: it is better
  bool stands_out = false;
};

struct RobotComparison {
  std::string robot;
  std::int64_t sessions = 0;
  std::int64_t queries = 0;
  std::int64_t localized = 0;
  // Queries whose matches contradict the calibration that was sent.
  std::int64_t calibration_inconsistent = 0;
  // Queries whose matches contradict the gravity that was sent, localized without it or not at all.
  std::int64_t gravity_rejected = 0;
  std::vector<RobotDifference> differences;  // ascending by metric; those that can be compared
  bool StandsOut() const;
  // Most of its queries are calibration_inconsistent, three at least (one pose may be wrong). Each
  // was judged by itself, so that this needs no other robot.
  bool CalibrationIsOff() const;
  // The same of gravity_rejected.
  bool GravityIsOff() const;
};

struct SessionComparison {
  SessionId session;
  std::vector<RobotDifference> differences;
  bool StandsOut() const;
};

struct FleetComparison {
  std::vector<RobotComparison> robots;      // by name
  std::vector<SessionComparison> sessions;  // in the order given
};

// In each segment a session's value is compared with the median of the ten nearest sessions of
// other robots, because a changed map affects all robots. A session's difference is the median over
// its segments (so one bad segment has no effect); a robot's difference is the median over its
// sessions. A session stands out only if it is worse than the nearest ones before it and than the
// nearest ones after it: one that is no worse than what followed saw the map change. (The first
// session after a change is flagged until another robot has followed.) The scatter is robust too:
// the median difference between two sessions of one robot, divided by 0.954. It is judged by
// Student's t, with a floor of a quarter of the smallest relevant difference. Needs two robots with
// a segment in common; with only two the worse one is flagged.
FleetComparison CompareRobots(std::span<const RobotSession> sessions);

}  // namespace maploc
