// One session of a robot against a server: start, every query, end, with each answer compared with
// the reference that the robot keeps to itself.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/api/client.h"
#include "client/robot/metrics.h"
#include "client/robot/robot.h"

namespace maploc {

enum class PriorMode {
  kNone,
  kPrevious,  // the position of the last localized answer
};

struct ReplayOptions {
  std::string robot = "maploc-replay";
  std::map<std::string, std::string> labels;
  std::optional<Strategy> strategy;  // unset: the segment's own
  Refinement refinement = Refinement::kAuto;
  std::optional<double> max_error_px;  // Query::max_error_px
  PriorMode prior = PriorMode::kNone;
  // Asked before each query; true ends the session early (CANCELLED). May be empty.
  std::function<bool()> stop;
  // A session that ends early counts, and its report is returned, with `failure`; else it is
  // discarded.
  bool keep_partial = false;
};

// As many queries in a row without an answer in time end a session: the server hangs, or its time
// is too short for any query.
inline constexpr int kMaxLateInARow = 5;

// What counts as right where lengths have no unit.
inline constexpr double kGoodDepthShare = 0.01;
inline constexpr double kGoodRotationDeg = 1.0;

struct ReplayEntry {
  std::string name;
  // DEADLINE_EXCEEDED where no answer came in time; `localization` is then empty, and the query
  // counts as not localized.
  Status failure;
  Localization localization;
  Rigid3 reference_map_from_body;
  std::optional<PoseError> error;     // with a pose alone
  std::optional<double> scene_depth;  // Robot::SceneDepth
  double latency_ms = 0.0;            // of the call, as the robot sees it

  // The outcome's name, or the failure's code.
  std::string_view OutcomeName() const;
  // The translation error's share of the scene's depth, where both are known.
  std::optional<double> DepthShare() const;
};

// Queries in which something that the robot sent was not believed.
struct InputFaults {
  int gravity_rejected = 0;          // localized without it
  int calibration_inconsistent = 0;  // not localized
};

struct ReplayReport {
  SessionId session;
  std::vector<ReplayEntry> entries;
  SessionSummary summary;
  Status failure;  // why the session ended early; ok with keep_partial unset

  // Queries without an answer in time.
  int CountLate() const;
  std::vector<std::optional<PoseError>> Errors() const;
  std::vector<double> LatenciesMs() const;
  InputFaults CountInputFaults() const;
  // Median DepthShare of those that have one.
  std::optional<double> MedianDepthShare() const;
  // Queries within 1% of the scene's depth and 1 degree; nullopt when no depth is known.
  std::optional<int> WithinDepthShare() const;
};

// Called after each answer, in order.
using ReplayObserver = std::function<void(const ReplayEntry&)>;

// A fault (not: an answer without a pose, nor one that comes too late) ends the session, takes its
// queries out of the statistics, and is returned with the query's name and the session's id.
Result<ReplayReport> Replay(const Client& client, const std::string& map, const Robot& robot,
                            const ReplayOptions& options, const ReplayObserver& observer);

}  // namespace maploc
