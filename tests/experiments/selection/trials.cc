#include "tests/experiments/selection/trials.h"

#include "mapstore/base/random.h"
#include "server/matching/pose_problem.h"
#include "server/matching/segment_matching.h"
#include "server/pipeline/body_pose.h"
#include "server/pipeline/localizer.h"
#include "server/retrieval/ranking.h"

namespace maploc::selection {
namespace {

// Index of the best ranked segment, as the localizer ranks; nullopt: out of the map.
std::optional<int> BestSegment(const Query& query, const MapSnapshot& map) {
  const RetrievalOptions options{
      .max_segments = 1,
      .max_ratio = MaxRatio(map.info.point_descriptor),
  };
  const std::vector<int> ranked =
      RankSegments(query.views.front().points, query.prior, *map.places, options).segments;
  return ranked.empty() ? std::nullopt : std::optional<int>(ranked.front());
}

Result<Observation> Observe(const SetQuery& query, const MapSnapshot& map, std::int64_t sequence) {
  MAPLOC_ASSIGN_OR_RETURN(const Localization answer,
                          Localize(query.query, map, LocalizerOptions{}, kNoDeadline, nullptr));
  Observation observation;
  observation.sequence = sequence;
  observation.segment = answer.segment;
  observation.outcome = answer.outcome;
  observation.evidence = answer.evidence;
  observation.total_ms = answer.times.total_ms;
  observation.time_unix_ns = sequence;
  return observation;
}

void TryShort(const SetQuery& query, const PoseProblem& problem, const TrialOptions& options,
              QueryResult& result) {
  for (int trial = 0; trial < options.trials; ++trial) {
    const std::uint64_t seed = HashBytes(query.name + "#" + std::to_string(trial), options.seed);
    const std::vector<Attempt> attempts = TryAllMethods(problem, options.short_search, seed);
    for (int i = 0; i < kMethodCount; ++i) {
      result.methods[i].errors.push_back(ErrorOf(attempts[i], query));
    }
  }
}

QueryResult TryQuery(const SelectionSet& set, const SetQuery& query, const TrialOptions& options) {
  QueryResult result;
  result.scene = query.scene;
  const std::optional<int> best = BestSegment(query.query, *set.map);
  if (!best) {
    for (MethodResult& method : result.methods) method.errors.resize(options.trials);
    return result;
  }
  const MapSnapshot::Entry entry = set.map->Load(*best, {}).value();  // it is in memory
  const Segment& segment = *entry.segment;
  result.segment = segment.id;
  const View& view = query.query.views.front();
  result.problem =
      BuildPoseProblem(MatchSegment(view, segment), view, segment, query.query.gravity).problem;
  TryShort(query, result.problem, options, result);
  for (MethodResult& method : result.methods) method.credit = AreaUnderCurve(method.errors);
  return result;
}

}  // namespace

std::optional<PoseError> ErrorOf(const Attempt& attempt, const SetQuery& query) {
  if (!attempt.camera_from_map) return std::nullopt;
  const Rigid3& camera_from_body = query.query.views.front().camera_from_body;
  return ErrorBetween(MapFromBody(*attempt.camera_from_map, camera_from_body), query.map_from_body);
}

Result<std::vector<QueryResult>> RunTrials(const SelectionSet& set, const SetSession& session,
                                           const TrialOptions& options,
                                           const ProgressFn& progress) {
  std::vector<QueryResult> results;
  const int count = static_cast<int>(session.queries.size());
  for (const SetQuery& query : session.queries) {
    results.push_back(TryQuery(set, query, options));
    const auto sequence = static_cast<std::int64_t>(results.size());
    MAPLOC_ASSIGN_OR_RETURN(results.back().observation, Observe(query, *set.map, sequence));
    if (progress) progress(session.name, static_cast<int>(results.size()), count);
  }
  return results;
}

}  // namespace maploc::selection
