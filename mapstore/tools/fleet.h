// What the robots' sessions of a map version say about the robots.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "mapstore/statistics/robots.h"
#include "mapstore/store/map_store.h"

namespace maploc {

// A session with its observations.
struct SeenSession {
  Session session;
  std::vector<Observation> observations;
};

// All sessions, oldest first.
Result<std::vector<SeenSession>> ReadSessions(const MapStore& store);
// Those of one map version.
Result<std::vector<SeenSession>> ReadSessions(const MapStore& store, const MapKey& key);

// Compares the robots of the unrevoked sessions of one map version (open ones as far as they went).
FleetComparison CompareFleet(const std::vector<SeenSession>& sessions, const MapKey& key);

// "gravity 5.1 (others 0.8) degrees" for each difference that stands out; empty: none.
std::string DescribeFlags(const std::vector<RobotDifference>& differences);
// In words what a robot's calibration is, by what its queries say, with cause and cure; empty where
// most of them say nothing against it.
std::string DescribeCalibration(const RobotComparison& robot);
// The same of the gravity that it sends.
std::string DescribeGravity(const RobotComparison& robot);
// [{"metric", "own", "others", "deviation", "stands_out"}]
nlohmann::ordered_json ToJson(const std::vector<RobotDifference>& differences);

}  // namespace maploc
