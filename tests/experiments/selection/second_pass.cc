#include "tests/experiments/selection/second_pass.h"

#include <algorithm>
#include <array>

#include "mapstore/base/random.h"
#include "server/ransac/stopping.h"
#include "server/trust/judge.h"
#include "tests/experiments/methods/cpu_timer.h"

namespace maploc::selection {
namespace {

constexpr int kRounds = 3;
constexpr int kPlaces = static_cast<int>(kStrategies.size()) + 1;
constexpr int kSelectionsPlace = kPlaces - 1;

// Whether the product would answer with this pose. Its time counts as the selection's.
bool IsTold(const PoseProblem& problem, const Camera& camera, const Attempt& attempt,
            Attempt& whole) {
  if (!attempt.camera_from_map) return false;
  const experiments::CpuTimer timer;
  TrustOptions trust;
  trust.gravity_was_sent = problem.has_gravity;
  trust.iterations = whole.iterations;
  const Verdict verdict = JudgePose(problem, attempt.refined, camera, trust);
  whole.ms += timer.ElapsedMs();
  return verdict.outcome == Outcome::kLocalized;
}

// The median time of the rounds; they all draw the same.
LongSearch MedianOf(std::array<Attempt, kRounds> rounds, const SetQuery& query) {
  std::ranges::sort(rounds, {}, &Attempt::ms);
  const Attempt& median = rounds[kRounds / 2];
  return {median.iterations, median.ms, ErrorOf(median, query)};
}

void RunQuery(const SetQuery& query, const StrategyDecision& decision, const TrialOptions& options,
              QueryResult& result) {
  const SearchLimits& limits = options.long_search;
  const Camera& camera = query.query.views.front().camera;
  const std::uint64_t seed = HashBytes(query.name + "#long", options.seed);
  std::array<std::array<Attempt, kRounds>, kPlaces> attempts;
  for (int round = 0; round < kRounds; ++round) {
    for (int i = 0; i < kPlaces; ++i) {
      const auto place = (static_cast<std::uint64_t>(i + round) + seed) % kPlaces;
      attempts[place][round] = place == kSelectionsPlace
                                   ? TryAsDecided(result.problem, camera, decision, limits, seed)
                                   : TryStrategy(result.problem, kStrategies[place], limits, seed);
    }
  }
  for (std::size_t i = 0; i < kStrategies.size(); ++i) {
    result.methods[AutoMethodOf(kStrategies[i])].to_the_end = MedianOf(attempts[i], query);
  }
  result.selection_to_the_end = MedianOf(attempts[kSelectionsPlace], query);
  const Attempt p3p = TryP3p(result.problem, limits, seed);
  result.methods[kP3pMethod].to_the_end = {p3p.iterations, p3p.ms, ErrorOf(p3p, query)};
}

}  // namespace

Attempt TryAsDecided(const PoseProblem& problem, const Camera& camera,
                     const StrategyDecision& decision, const SearchLimits& limits,
                     std::uint64_t seed) {
  SearchLimits own = limits;
  own.fall_back = false;
  own.max_iterations =
      Patience(decision.strategy, decision.predicted_success, limits.max_iterations);
  Attempt whole;
  for (const Strategy strategy : decision.ranking) {
    const Attempt attempt = TryStrategy(problem, strategy, own, seed);
    if (attempt.camera_from_map) whole.camera_from_map = attempt.camera_from_map;
    whole.iterations += attempt.iterations;
    whole.search_ms += attempt.search_ms;
    whole.ms += attempt.ms;
    const bool gave_up =
        own.max_iterations < limits.max_iterations && attempt.iterations >= own.max_iterations;
    if (gave_up ? IsTold(problem, camera, attempt, whole) : attempt.camera_from_map.has_value()) {
      break;
    }
    own.max_iterations = limits.max_iterations;
  }
  return whole;
}

void RunSecondPass(const SetSession& set, const LeftOut& left_out, const TrialOptions& options,
                   SessionResult& session) {
  for (std::size_t i = 0; i < session.queries.size(); ++i) {
    QueryResult& query = session.queries[i];
    if (query.segment < 0) continue;  // out of the map: nothing to search
    RunQuery(set.queries[i], DecisionFor(left_out, query.segment), options, query);
  }
}

}  // namespace maploc::selection
