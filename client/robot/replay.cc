#include "client/robot/replay.h"

#include <algorithm>
#include <chrono>

namespace maploc {
namespace {

constexpr double kPriorSigma = 5.0;  // in the map's unit: how far a robot may come between queries

bool IsLate(const ReplayEntry& entry) {
  return entry.failure.code() == StatusCode::kDeadlineExceeded;
}

// One query's way; keeps the last position for the prior.
class Runner {
 public:
  Runner(const Client& client, const std::string& map, const Robot& robot,
         const ReplayOptions& options, const SessionId& session)
      : client_(client), map_(map), robot_(robot), options_(options), session_(session) {}

  Result<ReplayEntry> Run(int index) {
    MAPLOC_ASSIGN_OR_RETURN(Query query, robot_.MakeQuery(index));
    query.map = map_;
    query.session = session_;
    query.requested_strategy = options_.strategy;
    query.refinement = options_.refinement;
    query.max_error_px = options_.max_error_px;
    query.prior = prior_;

    const auto start = std::chrono::steady_clock::now();
    Result<Localization> localization = client_.Localize(query);
    const std::chrono::duration<double, std::milli> latency =
        std::chrono::steady_clock::now() - start;

    ReplayEntry entry;
    entry.name = robot_.QueryName(index);
    entry.reference_map_from_body = robot_.ReferenceMapFromBody(index);
    entry.scene_depth = robot_.SceneDepth(index);
    entry.latency_ms = latency.count();
    entry.failure = localization.status();
    if (!localization.ok()) {
      // A late answer is an event of the drive, as a robot would have it. Any other failure is one
      // of the setup, which the next query would meet too.
      return IsLate(entry) ? Result<ReplayEntry>(entry) : localization.status();
    }
    if (localization->map_from_body) {
      entry.error = ErrorBetween(*localization->map_from_body, entry.reference_map_from_body);
      Remember(localization->map_from_body->translation);
    }
    entry.localization = *std::move(localization);
    return entry;
  }

 private:
  void Remember(const Eigen::Vector3d& position_in_map) {
    if (options_.prior == PriorMode::kPrevious) {
      prior_ = PosePrior{position_in_map, kPriorSigma};
    }
  }

  const Client& client_;
  const std::string& map_;
  const Robot& robot_;
  const ReplayOptions& options_;
  const SessionId& session_;
  std::optional<PosePrior> prior_;
};

// Every query, into the report, until one fails.
Status AskAll(Runner& runner, const Robot& robot, const ReplayOptions& options,
              const ReplayObserver& observer, ReplayReport& report) {
  int late_in_a_row = 0;
  for (int i = 0; i < robot.QueryCount(); ++i) {
    if (options.stop && options.stop()) {
      return Status(StatusCode::kCancelled, "INTERRUPTED", "interrupted");
    }
    const std::string query = "query '" + robot.QueryName(i) + "'";
    Result<ReplayEntry> entry = runner.Run(i);
    if (!entry.ok()) return entry.status().WithContext(query);
    late_in_a_row = IsLate(*entry) ? late_in_a_row + 1 : 0;
    report.entries.push_back(*std::move(entry));
    if (observer) observer(report.entries.back());
    if (late_in_a_row == kMaxLateInARow) {
      return report.entries.back().failure.WithContext(
          query + " is the " + std::to_string(kMaxLateInARow) + "th in a row without an answer");
    }
  }
  return Status::Ok();
}

// What has become of a session that is not whole, and the way back.
Status Explain(const Status& failure, const ReplayReport& report, const Robot& robot,
               const ReplayOptions& options, const Result<SessionSummary>& ended,
               const std::string& server) {
  const std::string& id = report.session;
  const std::string answers = std::to_string(report.entries.size()) + " of " +
                              std::to_string(robot.QueryCount()) + " answers";
  std::string text = failure.message() + "; session " + id;
  if (!ended.ok()) {
    text += " has " + answers + " and may be open still: `maploc end-session --server " + server +
            " --session " + id + "` ends it, `maploc-map revoke --store STORE --session " + id +
            "` takes it back";
  } else if (options.keep_partial) {
    text += " was ended after " + answers + ", and its " + std::to_string(ended->queries) +
            " queries count";
  } else {
    text += " was ended after " + answers + " and does not count";
  }
  return Status(failure.code(), failure.reason(), text);
}

}  // namespace

std::string_view ReplayEntry::OutcomeName() const {
  return failure.ok() ? maploc::OutcomeName(localization.outcome) : StatusCodeName(failure.code());
}

int ReplayReport::CountLate() const {
  return static_cast<int>(std::ranges::count_if(entries, IsLate));
}

std::optional<double> ReplayEntry::DepthShare() const {
  if (!error || !scene_depth || *scene_depth <= 0.0) return std::nullopt;
  return error->translation_m / *scene_depth;
}

std::vector<std::optional<PoseError>> ReplayReport::Errors() const {
  std::vector<std::optional<PoseError>> errors;
  for (const ReplayEntry& entry : entries) errors.push_back(entry.error);
  return errors;
}

std::vector<double> ReplayReport::LatenciesMs() const {
  std::vector<double> latencies_ms;
  for (const ReplayEntry& entry : entries) latencies_ms.push_back(entry.latency_ms);
  return latencies_ms;
}

InputFaults ReplayReport::CountInputFaults() const {
  InputFaults faults;
  for (const ReplayEntry& entry : entries) {
    const Localization& answer = entry.localization;
    faults.gravity_rejected += answer.evidence.gravity_rejected ? 1 : 0;
    faults.calibration_inconsistent += answer.outcome == Outcome::kCalibrationInconsistent ? 1 : 0;
  }
  return faults;
}

std::optional<double> ReplayReport::MedianDepthShare() const {
  std::vector<double> shares;
  for (const ReplayEntry& entry : entries) {
    if (const auto share = entry.DepthShare()) shares.push_back(*share);
  }
  return Quantile(std::move(shares), 0.5);
}

std::optional<int> ReplayReport::WithinDepthShare() const {
  if (std::ranges::none_of(
          entries, [](const ReplayEntry& entry) { return entry.scene_depth.has_value(); })) {
    return std::nullopt;
  }
  return static_cast<int>(std::ranges::count_if(entries, [](const ReplayEntry& entry) {
    const std::optional<double> share = entry.DepthShare();
    return share.has_value() && *share <= kGoodDepthShare &&
           entry.error->rotation_deg <= kGoodRotationDeg;
  }));
}

Result<ReplayReport> Replay(const Client& client, const std::string& map, const Robot& robot,
                            const ReplayOptions& options, const ReplayObserver& observer) {
  ReplayReport report;
  MAPLOC_ASSIGN_OR_RETURN(report.session, client.StartSession(map, options.robot, options.labels));
  Runner runner(client, map, robot, options, report.session);
  report.failure = AskAll(runner, robot, options, observer, report);
  // The session is ended in any case. Left open it would be ended by the server after its idle
  // time, and count.
  const bool counts = report.failure.ok() || options.keep_partial;
  const Result<SessionSummary> ended =
      counts ? client.EndSession(report.session) : client.DiscardSession(report.session);
  if (ended.ok()) report.summary = *ended;
  if (report.failure.ok()) report.failure = ended.status();
  if (report.failure.ok()) return report;
  report.failure = Explain(report.failure, report, robot, options, ended, client.server());
  if (!options.keep_partial) return report.failure;
  return report;
}

}  // namespace maploc
