#include "mapstore/tools/fleet.h"

#include "mapstore/base/angles.h"
#include "mapstore/base/text.h"

namespace maploc {
namespace {

std::string Describe(const RobotDifference& difference) {
  const bool gravity = difference.metric == RobotMetric::kGravity;
  const double unit = gravity ? kDegPerRad : 1.0;
  const int decimals = gravity ? 1 : 2;
  return std::string(RobotMetricName(difference.metric)) + " " +
         FixedText(unit * difference.own, decimals) + " (others " +
         FixedText(unit * difference.others, decimals) + ")" + (gravity ? " degrees" : "");
}

Result<std::vector<SeenSession>> WithObservations(const MapStore& store,
                                                  const std::vector<Session>& sessions) {
  std::vector<SeenSession> seen;
  for (const Session& session : sessions) {
    MAPLOC_ASSIGN_OR_RETURN(auto observations, store.ListObservations(session.id));
    seen.push_back({session, std::move(observations)});
  }
  return seen;
}

}  // namespace

Result<std::vector<SeenSession>> ReadSessions(const MapStore& store) {
  MAPLOC_ASSIGN_OR_RETURN(const auto sessions, store.ListSessions());
  return WithObservations(store, sessions);
}

Result<std::vector<SeenSession>> ReadSessions(const MapStore& store, const MapKey& key) {
  MAPLOC_ASSIGN_OR_RETURN(auto sessions, store.ListSessions());
  std::erase_if(sessions, [&](const Session& session) { return session.map != key; });
  return WithObservations(store, sessions);
}

FleetComparison CompareFleet(const std::vector<SeenSession>& sessions, const MapKey& key) {
  std::vector<RobotSession> fleet;
  for (const SeenSession& seen : sessions) {
    const Session& session = seen.session;
    // Another version has other landmarks, so that its ratios cannot be compared with these. What
    // was revoked is not to make an honest robot stand out.
    if (session.revoked || session.map != key) continue;
    fleet.push_back({session.id, session.robot, session.start_unix_ns, seen.observations});
  }
  return CompareRobots(fleet);
}

std::string DescribeFlags(const std::vector<RobotDifference>& differences) {
  std::string text;
  for (const RobotDifference& difference : differences) {
    if (!difference.stands_out) continue;
    text += (text.empty() ? "" : ", ") + Describe(difference);
  }
  return text;
}

std::string DescribeCalibration(const RobotComparison& robot) {
  if (!robot.CalibrationIsOff()) return "";
  return "the matches of " + std::to_string(robot.calibration_inconsistent) + " of its " +
         std::to_string(robot.queries) +
         " queries contradict the camera calibration that it sends: focal length or distortion are "
         "another camera's, or of pictures before they were resized or cropped, or focus or zoom "
         "moved since; calibrate the camera again, with pictures as they are sent";
}

std::string DescribeGravity(const RobotComparison& robot) {
  if (!robot.GravityIsOff()) return "";
  return "the matches of " + std::to_string(robot.gravity_rejected) + " of its " +
         std::to_string(robot.queries) +
         " queries contradict the gravity that it sends: it is up instead of down, or in another "
         "frame than the camera's (or the body's, with camera_from_body), or its pictures are "
         "turned; send the direction down in the frame of the camera: x right, y down, z forward";
}

nlohmann::ordered_json ToJson(const std::vector<RobotDifference>& differences) {
  auto json = nlohmann::ordered_json::array();
  for (const RobotDifference& difference : differences) {
    json.push_back({{"metric", RobotMetricName(difference.metric)},
                    {"own", difference.own},
                    {"others", difference.others},
                    {"deviation", difference.deviation},
                    {"stands_out", difference.stands_out}});
  }
  return json;
}

}  // namespace maploc
