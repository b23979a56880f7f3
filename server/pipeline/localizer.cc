#include "server/pipeline/localizer.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "mapstore/base/random.h"
#include "server/matching/pose_problem.h"
#include "server/matching/segment_matching.h"
#include "server/pipeline/body_pose.h"
#include "server/pipeline/interrupt.h"
#include "server/pipeline/joint_segment.h"
#include "server/pipeline/judge.h"
#include "server/pipeline/query_check.h"
#include "server/pipeline/stopwatch.h"
#include "server/ransac/estimator.h"
#include "server/refinement/gravity_check.h"
#include "server/refinement/refine.h"
#include "server/retrieval/ranking.h"

namespace maploc {
namespace {

// Hypotheses without gravity after those with a wrong one failed: enough for matches of which a
// sixth are right, at a cost that every query without an answer can bear.
constexpr int kIterationsAgainstGravity = 2000;

// When a segment's matches are tried once more as if gravity had not been measured.
enum class AgainstGravity { kNever, kIfInconsistent, kIfNotLocalized };

// What stays the same while one query walks through its segments.
struct Context {
  const Query& query;
  const MapSnapshot& map;
  const LocalizerOptions& options;
  Interrupt interrupt;
  std::uint64_t seed;

  const View& view() const { return query.views.front(); }
};

std::vector<int> Rank(const Context& context, StageTimes& times) {
  const Stopwatch watch(times.retrieval_ms);
  std::vector<std::shared_ptr<const Segment>> segments;
  for (const MapSnapshot::Entry& entry : context.map.segments) segments.push_back(entry.segment);
  const RetrievalOptions options{
      .max_segments = context.options.max_segments_tried,
      .max_ratio = MaxRatio(context.map.info.point_descriptor),
  };
  return RankSegments(context.view().points, context.query.prior, segments, *context.map.places,
                      options);
}

MatchedProblem Match(const Context& context, const Segment& segment, StageTimes& times) {
  const Stopwatch watch(times.matching_ms);
  const Matches matches = MatchSegment(context.view(), segment);
  return BuildPoseProblem(matches, context.view(), segment, context.query.gravity);
}

// The smallest samples of any strategy with gravity are two points, or a point and a line.
bool CanDraw(const PoseProblem& problem) {
  if (!problem.has_gravity) return problem.points.size() >= 3;
  return problem.points.size() >= 2 || (!problem.points.empty() && !problem.lines.empty());
}

Strategy ChooseStrategy(const Context& context, const StrategyDecision& decision) {
  return context.query.requested_strategy.value_or(decision.strategy);
}

// The strategies whose poses are refined and judged in turn until one is LOCALIZED. The segment's
// own ranking where nobody asked for a strategy; without gravity every sample is three points.
std::vector<Strategy> StrategiesToTry(const Context& context, const StrategyDecision& decision,
                                      const PoseProblem& problem, bool fall_back) {
  if (!problem.has_gravity) return {Strategy::kP3P};
  std::vector<Strategy> strategies = {ChooseStrategy(context, decision)};
  if (!fall_back || context.query.requested_strategy) return strategies;
  std::ranges::copy_if(decision.ranking, std::back_inserter(strategies),
                       [&](Strategy next) { return next != strategies.front(); });
  return strategies;
}

// `fall_back`: to the next in the segment's ranking where `strategy` draws or finds nothing.
Consensus Estimate(const Context& context, const MapSnapshot::Entry& entry,
                   const PoseProblem& problem, Strategy strategy, bool fall_back,
                   StageTimes& times) {
  const Stopwatch watch(times.ransac_ms);
  RansacOptions options;
  options.strategy = strategy;
  options.fall_back = fall_back;
  options.fallbacks.assign(entry.decision.ranking.begin(), entry.decision.ranking.end());
  if (!problem.has_gravity && context.query.gravity) {
    options.max_iterations = kIterationsAgainstGravity;
  }
  options.max_reprojection_error_px = context.options.max_reprojection_error_px;
  options.seed = Random(context.seed).Fork(entry.segment->id).Next();
  options.deadline = context.interrupt.deadline;
  options.cancelled = context.interrupt.cancelled;
  Consensus consensus = EstimateConsensus(problem, options);
  consensus.fell_back = consensus.strategy != ChooseStrategy(context, entry.decision);
  return consensus;
}

RefineOptions Refining(const Context& context) {
  RefineOptions options;
  options.mode = context.query.refinement;
  options.max_reprojection_error_px = context.options.max_reprojection_error_px;
  return options;
}

// An answer about `entry`'s segment without a pose as yet.
Localization Begin(const Context& context, const MapSnapshot::Entry& entry) {
  Localization answer;
  answer.map = context.map.info.key;
  answer.segment = entry.segment->id;
  answer.strategy_source =
      context.query.requested_strategy ? StrategySource::kRequested : entry.decision.source;
  answer.evidence.strategy = ChooseStrategy(context, entry.decision);
  answer.predicted_success = entry.decision.predicted_success;
  return answer;
}

void FillEvidence(const PoseProblem& problem, const RefinedPose& pose, const Consensus& consensus,
                  Evidence& evidence) {
  evidence = CountEvidence(problem, pose);
  evidence.strategy = consensus.strategy;
  evidence.fell_back = consensus.fell_back;
  evidence.iterations = consensus.iterations;
}

void FillPose(const Context& context, const RefinedPose& pose, Localization& answer) {
  const Rigid3& camera_from_body = context.view().camera_from_body;
  answer.map_from_body = MapFromBody(pose.camera_from_map, camera_from_body);
  answer.covariance = BodyCovariance(pose.covariance, pose.camera_from_map, camera_from_body);
}

// `problem` has gravity as it was sent, or not at all: then the pose was found without it, and is
// told to contradict it where it does.
void Judge(const Context& context, const PoseProblem& problem, const RefinedPose& pose,
           const GravityCheck& gravity, int iterations, Localization& answer) {
  const JudgeOptions options{
      .contradicts_gravity = problem.has_gravity && !gravity.consistent,
      .min_confidence = context.options.min_confidence,
      .max_reprojection_error_px = context.options.max_reprojection_error_px,
      .iterations = iterations,
  };
  const Verdict verdict = JudgePose(problem, pose, context.view().camera, options);
  answer.outcome = verdict.outcome;
  answer.evidence.confidence = verdict.confidence;
  answer.evidence.gravity_disagreement_rad = gravity.disagreement_rad;
  if (verdict.outcome != Outcome::kLocalized) return;
  answer.evidence.gravity_rejected = !gravity.consistent;
  FillPose(context, pose, answer);
}

// What one attempt on a segment's matches works with: `problem`, and the same with the gravity that
// was sent; the first strategy to draw by, and whether RANSAC itself may take the next ones.
struct Attempt {
  const MapSnapshot::Entry& entry;
  const PoseProblem& problem;
  const PoseProblem& as_sent;
  Strategy strategy;
  bool fall_back;
};

// A segment's matches through RANSAC, refinement and judgement. `iterations` counts on over all
// attempts of a query; `times` add up.
Result<Localization> TryStrategy(const Context& context, const Attempt& attempt,
                                 Localization answer, int& iterations, StageTimes& times) {
  const auto& [entry, problem, as_sent, strategy, fall_back] = attempt;
  const Consensus consensus = Estimate(context, entry, problem, strategy, fall_back, times);
  MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  iterations += consensus.iterations;
  FillEvidence(problem, RefinedPose(), consensus, answer.evidence);
  answer.outcome = Outcome::kNoConsensus;
  if (!consensus.found) return answer;

  const Stopwatch watch(times.refinement_ms);
  const RefinedPose pose = RefinePose(problem, consensus.camera_from_map, Refining(context));
  if (!pose.converged) return answer;
  FillEvidence(problem, pose, consensus, answer.evidence);
  answer.point_match_inlier = pose.point_inliers;
  answer.line_match_inlier = pose.line_inliers;
  const GravityCheck gravity = CheckGravity(as_sent, pose, Refining(context));
  Judge(context, problem, pose, gravity, iterations, answer);
  return answer;
}

// Whether another strategy may find what this one has not. A pose that contradicts gravity was
// found: the others would find it too.
bool FoundNothing(Outcome outcome) {
  return outcome != Outcome::kLocalized && outcome != Outcome::kGravityInconsistent;
}

// A segment's matches with its strategy, and with the next best ones (`fall_back`) until one finds
// a pose to be told. Where none does, the one of the most confidence is told, of equals the first;
// iterations are those of all.
Result<Localization> TryMatches(const Context& context, const MapSnapshot::Entry& entry,
                                const PoseProblem& problem, const PoseProblem& as_sent,
                                bool fall_back, const Localization& start, int& iterations,
                                StageTimes& times) {
  if (!CanDraw(problem)) return start;
  const std::vector<Strategy> strategies =
      StrategiesToTry(context, entry.decision, problem, fall_back);
  std::optional<Localization> told;
  int spent = 0;
  for (const Strategy strategy : strategies) {
    const Attempt attempt{entry, problem, as_sent, strategy, strategies.size() == 1};
    MAPLOC_ASSIGN_OR_RETURN(Localization answer,
                            TryStrategy(context, attempt, start, iterations, times));
    spent += answer.evidence.iterations;
    const bool last = !FoundNothing(answer.outcome);
    if (!told || last || answer.evidence.confidence > told->evidence.confidence) {
      told = std::move(answer);
    }
    if (last) break;
  }
  told->evidence.iterations = spent;
  return *std::move(told);
}

bool IsTried(AgainstGravity when, Outcome outcome) {
  switch (when) {
    case AgainstGravity::kNever:
      break;
    case AgainstGravity::kIfInconsistent:
      return outcome == Outcome::kGravityInconsistent;
    case AgainstGravity::kIfNotLocalized:
      return outcome != Outcome::kLocalized;
  }
  return false;
}

// One segment through matching and all that follows; once more without the gravity that was sent
// where that may be what is wrong. Only a LOCALIZED answer is taken from that second attempt.
Result<Localization> TrySegment(const Context& context, const MapSnapshot::Entry& entry,
                                AgainstGravity against_gravity, int& iterations,
                                StageTimes& times) {
  MatchedProblem matched = Match(context, *entry.segment, times);
  PoseProblem& problem = matched.problem;
  Localization start = Begin(context, entry);
  start.matches = std::move(matched.matches);
  start.evidence = CountEvidence(problem, RefinedPose());
  start.evidence.strategy = ChooseStrategy(context, entry.decision);
  start.point_match_inlier.assign(problem.points.size(), 0);
  start.line_match_inlier.assign(problem.lines.size(), 0);
  start.outcome = Outcome::kTooFewMatches;
  MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  // The next best strategies are as dear as an attempt without gravity, and tried where that is.
  const bool fall_back = against_gravity != AgainstGravity::kNever;
  MAPLOC_ASSIGN_OR_RETURN(Localization answer, TryMatches(context, entry, problem, problem,
                                                          fall_back, start, iterations, times));
  if (!problem.has_gravity || !IsTried(against_gravity, answer.outcome)) return answer;

  PoseProblem without = problem;
  without.has_gravity = false;
  MAPLOC_ASSIGN_OR_RETURN(Localization free, TryMatches(context, entry, without, problem, fall_back,
                                                        start, iterations, times));
  if (free.outcome != Outcome::kLocalized) return answer;
  free.evidence.iterations += answer.evidence.iterations;
  return free;
}

// All ranked segments as one, where each alone was too little. The answer is told as one about the
// segment that holds most of its inliers.
Result<Localization> TryJointly(const Context& context, const std::vector<int>& ranked,
                                int& iterations, StageTimes& times) {
  std::vector<std::shared_ptr<const Segment>> parts;
  for (const int index : ranked) parts.push_back(context.map.segments[index].segment);
  const auto joint = std::make_shared<const Segment>(JoinSegments(parts));
  const MapSnapshot::Entry entry{joint, context.map.segments[ranked.front()].decision};
  MAPLOC_ASSIGN_OR_RETURN(
      Localization answer,
      TrySegment(context, entry, AgainstGravity::kIfNotLocalized, iterations, times));
  TellOfOnePart(*joint, parts, answer);
  return answer;
}

// The best ranked segment, then all ranked ones together, then the others alone, until one answers.
// A wrong gravity costs at most two more searches: where the first segment's matches contradict it,
// and where all matches together found nothing.
// Where none does, the best ranked one speaks: a query counts in exactly one segment.
Result<Localization> TrySegments(const Context& context, const std::vector<int>& ranked,
                                 StageTimes& times) {
  int iterations = 0;
  const auto try_one = [&](int index, AgainstGravity against_gravity) {
    return TrySegment(context, context.map.segments[index], against_gravity, iterations, times);
  };
  const bool alone = ranked.size() == 1;
  MAPLOC_ASSIGN_OR_RETURN(Localization first,
                          try_one(ranked.front(), alone ? AgainstGravity::kIfNotLocalized
                                                        : AgainstGravity::kIfInconsistent));
  if (first.outcome == Outcome::kLocalized || alone) return first;
  MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  MAPLOC_ASSIGN_OR_RETURN(Localization together, TryJointly(context, ranked, iterations, times));
  if (together.outcome == Outcome::kLocalized) return together;
  for (std::size_t i = 1; i < ranked.size(); ++i) {
    MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
    MAPLOC_ASSIGN_OR_RETURN(Localization answer, try_one(ranked[i], AgainstGravity::kNever));
    if (answer.outcome == Outcome::kLocalized) return answer;
  }
  return first;
}

Localization OutOfMap(const Context& context) {
  Localization answer;
  answer.map = context.map.info.key;
  answer.outcome = Outcome::kOutOfMap;
  if (context.query.requested_strategy) {
    answer.evidence.strategy = *context.query.requested_strategy;
    answer.strategy_source = StrategySource::kRequested;
  }
  return answer;
}

}  // namespace

Result<Localization> Localize(const Query& query, const MapSnapshot& map,
                              const LocalizerOptions& options, Deadline deadline,
                              const std::atomic<bool>* cancelled) {
  StageTimes times;
  Localization answer;
  {
    const Stopwatch watch(times.total_ms);
    MAPLOC_RETURN_IF_ERROR(CheckQuery(query, map.info));
    const Context context{
        query, map, options, {deadline, cancelled}, options.seed ^ ContentHash(query)};
    MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
    const std::vector<int> ranked = Rank(context, times);
    if (ranked.empty()) {
      answer = OutOfMap(context);
    } else {
      MAPLOC_ASSIGN_OR_RETURN(answer, TrySegments(context, ranked, times));
    }
  }
  answer.times = times;
  return answer;
}

}  // namespace maploc
