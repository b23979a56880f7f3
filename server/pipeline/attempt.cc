#include "server/pipeline/attempt.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "mapstore/base/random.h"
#include "server/pipeline/body_pose.h"
#include "server/pipeline/stopwatch.h"
#include "server/ransac/estimator.h"
#include "server/ransac/stopping.h"
#include "server/refinement/refine.h"
#include "server/solvers/reprojection.h"
#include "server/trust/judge.h"

namespace maploc {
namespace {

// The smallest samples of any strategy with gravity are two points, or a point and a line.
bool CanDraw(const PoseProblem& problem) {
  if (!problem.has_gravity) return problem.points.size() >= 3;
  return problem.points.size() >= 2 || (!problem.points.empty() && !problem.lines.empty());
}

// The strategies whose poses are refined and judged in turn until one is LOCALIZED. The segment's
// own ranking where nobody asked for a strategy; without gravity every sample is three points.
std::vector<Strategy> StrategiesToTry(const QueryContext& context, const StrategyDecision& decision,
                                      const PoseProblem& problem, bool fall_back) {
  if (!problem.has_gravity) return {Strategy::kP3P};
  std::vector<Strategy> strategies = {ChooseStrategy(context, decision)};
  if (!fall_back || context.query.requested_strategy) return strategies;
  std::ranges::copy_if(decision.ranking, std::back_inserter(strategies),
                       [&](Strategy next) { return next != strategies.front(); });
  return strategies;
}

// What one attempt on a segment's matches works with: the first strategy to draw by, and whether
// RANSAC itself may take the next ones.
struct Attempt {
  const MapSnapshot::Entry& entry;
  const PoseProblem& problem;
  bool gravity_was_sent;  // `problem` may have it not, all the same
  Strategy strategy;
  bool fall_back;
  std::optional<int> max_iterations = std::nullopt;  // unset: as the segment's statistics say
  std::optional<Consensus> known = std::nullopt;     // instead of RANSAC's
  double sampled_share = 1.0;                        // of the points, that were matched
};

// `fall_back`: to the next in the segment's ranking where `strategy` draws or finds nothing. Else
// the judgement decides on the next, and the segment's own strategy is given no more iterations
// than its statistics make worth while.
Consensus Estimate(const QueryContext& context, const Attempt& attempt, const PoseProblem& problem,
                   bool fall_back, StageTimes& times) {
  const Stopwatch watch(times.ransac_ms);
  const auto& [segment, decision] = attempt.entry;
  const Strategy strategy = attempt.strategy;
  RansacOptions options;
  options.strategy = strategy;
  options.fall_back = fall_back;
  options.fallbacks.assign(decision.ranking.begin(), decision.ranking.end());
  if (attempt.max_iterations) {
    options.max_iterations = *attempt.max_iterations;
  } else if (!problem.has_gravity && context.query.gravity) {
    options.max_iterations = kIterationsAgainstGravity;
  } else if (!fall_back && strategy == decision.strategy) {
    options.max_iterations = Patience(strategy, decision.predicted_success, options.max_iterations);
  }
  options.max_reprojection_error_px = context.MaxErrorVgaPx();
  // A segment's draws do not depend on what was tried before it.
  options.seed = Random(context.seed).Fork(segment->id).Next();
  options.deadline = context.interrupt.deadline;
  options.cancelled = context.interrupt.cancelled;
  Consensus consensus = EstimateConsensus(problem, options);
  // Told against what was recorded or asked for: `strategy` may itself be the pipeline's next one.
  consensus.fell_back = consensus.strategy != ChooseStrategy(context, decision);
  return consensus;
}

RefineOptions Refining(const QueryContext& context) {
  RefineOptions options;
  options.mode = context.query.refinement;
  options.max_reprojection_error_px = context.MaxErrorVgaPx();
  return options;
}

void FillEvidence(const PoseProblem& problem, const RefinedPose& pose, const Consensus& consensus,
                  Evidence& evidence) {
  evidence = CountEvidence(problem, pose);
  evidence.strategy = consensus.strategy;
  evidence.fell_back = consensus.fell_back;
  evidence.iterations = consensus.iterations;
}

PoseProblem PointsAlone(PoseProblem problem) {
  problem.lines.clear();
  return problem;
}

// A consensus with its refined pose; which of the problem's features were heard.
struct Found {
  Consensus consensus;
  RefinedPose pose;  // not converged where there is none
  bool with_lines = true;
};

void FillPose(const QueryContext& context, const RefinedPose& pose, Localization& answer) {
  const Rigid3& camera_from_body = context.view().camera_from_body;
  answer.map_from_body = MapFromBody(pose.camera_from_map, camera_from_body);
  answer.covariance = BodyCovariance(pose.covariance, pose.camera_from_map, camera_from_body);
}

// Tells the pose that the verdict is about. Lines that were not heard count as they agree with it
// all the same: else statistics would never see them come back.
void Tell(const QueryContext& context, const PoseProblem& problem, const Verdict& verdict,
          const Consensus& consensus, Localization& answer) {
  RefinedPose told = verdict.pose;
  if (told.line_inliers.size() != problem.lines.size()) {
    told.line_inliers = FindInliers(problem, told.camera_from_map, context.MaxErrorVgaPx()).lines;
  }
  FillEvidence(problem, told, consensus, answer.evidence);
  if (verdict.is_rival) {
    answer.evidence.strategy = Strategy::kP3P;
    answer.evidence.fell_back = true;
  }
  answer.point_match_inlier = told.point_inliers;
  answer.line_match_inlier = told.line_inliers;
  answer.outcome = verdict.outcome;
  answer.evidence.confidence = verdict.confidence;
  answer.evidence.gravity_disagreement_rad = verdict.gravity.disagreement_rad;
  answer.evidence.inlier_rms_px = PixelScale(context.view().camera) * verdict.pose.inlier_rms_px;
  answer.evidence.focal_scale = verdict.focal_scale;
  answer.evidence.gravity_tilt_rad = verdict.gravity.tilt_rad;
  if (verdict.outcome != Outcome::kLocalized) return;
  answer.evidence.gravity_rejected = !verdict.gravity.consistent;
  FillPose(context, verdict.pose, answer);
}

Found FindPose(const QueryContext& context, const Attempt& attempt, const PoseProblem& problem,
               bool fall_back, StageTimes& times) {
  Found found;
  found.consensus =
      attempt.known ? *attempt.known : Estimate(context, attempt, problem, fall_back, times);
  if (!found.consensus.found) return found;
  const Stopwatch watch(times.refinement_ms);
  found.pose = RefinePose(problem, found.consensus.camera_from_map, Refining(context));
  return found;
}

TrustOptions Trusting(const QueryContext& context, const Attempt& attempt, int iterations) {
  return {.refine = Refining(context),
          .min_confidence = context.options.min_confidence,
          .gravity_was_sent = attempt.gravity_was_sent,
          .iterations = iterations,
          .sampled_share = attempt.sampled_share};
}

// Lines that agree no better than chance (a day's map at night) only lead astray: then the points
// alone are searched.
Found FindPoseByWhatIsHeard(const QueryContext& context, const Attempt& attempt, int iterations,
                            StageTimes& times) {
  Found found = FindPose(context, attempt, attempt.problem, attempt.fall_back, times);
  if (!found.pose.converged || attempt.problem.lines.empty()) return found;
  if (!LinesAreAtChance(attempt.problem, found.pose, context.view().camera,
                        Trusting(context, attempt, iterations))) {
    return found;
  }
  // With fallbacks, because a strategy that draws lines has no sample here.
  Found by_points = FindPose(context, attempt, PointsAlone(attempt.problem), true, times);
  // All hypotheses of a query count in the test against chance.
  by_points.consensus.iterations += found.consensus.iterations;
  by_points.with_lines = false;
  return by_points;
}

// A segment's matches through RANSAC, refinement and judgement. `iterations` counts on over all
// attempts of a query; `times` add up.
Result<Localization> TryStrategy(const QueryContext& context, const Attempt& attempt,
                                 Localization answer, int& iterations, StageTimes& times) {
  const Found found = FindPoseByWhatIsHeard(context, attempt, iterations, times);
  MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  iterations += found.consensus.iterations;
  // Told without a pose, in case that none follows.
  FillEvidence(attempt.problem, RefinedPose(), found.consensus, answer.evidence);
  answer.outcome = Outcome::kNoConsensus;
  if (!found.pose.converged) return answer;

  const Stopwatch watch(times.refinement_ms);
  const Verdict verdict =
      JudgePose(found.with_lines ? attempt.problem : PointsAlone(attempt.problem), found.pose,
                context.view().camera, Trusting(context, attempt, iterations));
  Tell(context, attempt.problem, verdict, found.consensus, answer);
  return answer;
}

// Whether another strategy may find what this one has not. A pose that contradicts gravity or the
// calibration was found: the others would find it too.
bool FoundNothing(Outcome outcome) {
  return outcome != Outcome::kLocalized && outcome != Outcome::kGravityInconsistent &&
         outcome != Outcome::kCalibrationInconsistent;
}

}  // namespace

Strategy ChooseStrategy(const QueryContext& context, const StrategyDecision& decision) {
  return context.query.requested_strategy.value_or(decision.strategy);
}

Result<Localization> TryMatches(const QueryContext& context, const MapSnapshot::Entry& entry,
                                const PoseProblem& problem, bool fall_back,
                                const Localization& start, int& iterations, StageTimes& times) {
  if (!CanDraw(problem)) return start;
  const std::vector<Strategy> strategies =
      StrategiesToTry(context, entry.decision, problem, fall_back);
  std::optional<Localization> told;
  int spent = 0;
  for (const Strategy strategy : strategies) {
    // Where no next strategy follows RANSAC may fall back itself, if this one has no sample or
    // finds no consensus.
    const Attempt attempt{entry, problem, context.query.gravity.has_value(), strategy,
                          strategies.size() == 1};
    Result<Localization> answer = TryStrategy(context, attempt, start, iterations, times);
    if (!answer.ok()) {
      if (told && IsOutOfTime(answer.status())) break;
      return answer.status();
    }
    spent += answer->evidence.iterations;
    const bool last = !FoundNothing(answer->outcome);
    if (!told || last || answer->evidence.confidence > told->evidence.confidence) {
      told = *std::move(answer);
    }
    if (last) break;
  }
  told->evidence.iterations = spent;
  return *std::move(told);
}

MatchedProblem MakeProblem(const QueryContext& context, const Segment& segment,
                           const Matches& matches) {
  MatchedProblem matched =
      BuildPoseProblem(matches, context.view(), segment, context.query.gravity);
  matched.problem.shared_error_rad = context.map.info.shared_error_rad;
  return matched;
}

Localization StartAnswer(const QueryContext& context, const MapSnapshot::Entry& entry,
                         const MatchedProblem& matched) {
  Localization answer;
  answer.map = context.map.info.key;
  answer.segment = entry.segment->id;
  answer.strategy_source =
      context.query.requested_strategy ? StrategySource::kRequested : entry.decision.source;
  answer.predicted_success = entry.decision.predicted_success;
  answer.matches = matched.matches;
  answer.evidence = CountEvidence(matched.problem, RefinedPose());
  answer.evidence.strategy = ChooseStrategy(context, entry.decision);
  answer.point_match_inlier.assign(matched.problem.points.size(), 0);
  answer.line_match_inlier.assign(matched.problem.lines.size(), 0);
  answer.outcome = Outcome::kTooFewMatches;
  return answer;
}

Result<Localization> TrySample(const QueryContext& context, const MapSnapshot::Entry& entry,
                               const MatchedProblem& matched, double sampled_share,
                               int max_iterations, int& iterations, StageTimes& times) {
  const Localization start = StartAnswer(context, entry, matched);
  if (!CanDraw(matched.problem)) return start;
  const Strategy strategy =
      matched.problem.has_gravity ? ChooseStrategy(context, entry.decision) : Strategy::kP3P;
  const Attempt attempt{entry,
                        matched.problem,
                        context.query.gravity.has_value(),
                        strategy,
                        /*fall_back=*/false,
                        max_iterations,
                        /*known=*/std::nullopt,
                        sampled_share};
  return TryStrategy(context, attempt, start, iterations, times);
}

Result<Localization> RefineKnown(const QueryContext& context, const MapSnapshot::Entry& entry,
                                 const MatchedProblem& matched, const Localization& known,
                                 StageTimes& times) {
  Consensus consensus;
  consensus.found = true;
  consensus.camera_from_map = context.view().camera_from_body * known.map_from_body->Inverse();
  consensus.strategy = known.evidence.strategy;
  consensus.fell_back = known.evidence.fell_back;
  const Attempt attempt{entry,
                        matched.problem,
                        context.query.gravity.has_value(),
                        consensus.strategy,
                        /*fall_back=*/false,
                        /*max_iterations=*/std::nullopt,
                        consensus};
  // A copy: nothing is drawn here, so the query's own count does not change.
  int iterations = known.evidence.iterations;
  MAPLOC_ASSIGN_OR_RETURN(
      Localization answer,
      TryStrategy(context, attempt, StartAnswer(context, entry, matched), iterations, times));
  answer.evidence.iterations = known.evidence.iterations;
  return answer;
}

}  // namespace maploc
