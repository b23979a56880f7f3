#include "mapstore/tools/lean_warning.h"

#include <cstdio>
#include <map>

#include "mapstore/base/angles.h"
#include "mapstore/statistics/lean.h"

namespace maploc {
namespace {

// By map version and robot. A query whose gravity was not compared has no tilt.
std::map<MapKey, std::map<std::string, RobotTilts>> CollectTilts(
    const std::vector<SeenSession>& sessions) {
  std::map<MapKey, std::map<std::string, RobotTilts>> tilts;
  for (const SeenSession& seen : sessions) {
    if (seen.session.revoked) continue;
    RobotTilts& robot = tilts[seen.session.map][seen.session.robot];
    robot.robot = seen.session.robot;
    for (const Observation& observation : seen.observations) {
      if (observation.evidence.gravity_disagreement_rad <= 0) continue;
      robot.tilts_rad.push_back(observation.evidence.gravity_tilt_rad);
    }
  }
  return tilts;
}

std::string Describe(const MapKey& map, const Lean& lean) {
  const Eigen::Vector3d down = GravityOfLean(lean.tilt_rad);
  // A name has kMaxIdBytes at most; the rest, with its numbers, stays below 192.
  char text[320];
  std::snprintf(
      text, sizeof(text),
      "gravity of version %lld is off by %.1f degrees (95%% interval %.1f) according to all "
      "%lld robots in %lld queries; correct it: maploc-map level --map %s --gravity "
      "%.5f,%.5f,%.5f",
      static_cast<long long>(map.version), lean.tilt_rad.norm() * kDegPerRad,
      lean.interval_rad * kDegPerRad, static_cast<long long>(lean.robots),
      static_cast<long long>(lean.queries), map.name.c_str(), down.x(), down.y(), down.z());
  return "map " + map.name + ": " + text;
}

}  // namespace

std::vector<std::string> DescribeLeans(const std::vector<SeenSession>& sessions) {
  std::vector<std::string> lines;
  for (const auto& [map, by_robot] : CollectTilts(sessions)) {
    std::vector<RobotTilts> robots;
    for (const auto& [name, tilts] : by_robot) robots.push_back(tilts);
    const Lean lean = FindLean(robots);
    if (lean.leans) lines.push_back(Describe(map, lean));
  }
  return lines;
}

}  // namespace maploc
