#include "server/pipeline/localizer.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "mapstore/base/random.h"
#include "server/matching/joint_matching.h"
#include "server/matching/mirrored.h"
#include "server/matching/segment_matching.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/coarse_to_fine.h"
#include "server/pipeline/interrupt.h"
#include "server/pipeline/joint_segment.h"
#include "server/pipeline/query_check.h"
#include "server/pipeline/stopwatch.h"
#include "server/pipeline/tried_segments.h"
#include "server/pipeline/twins.h"
#include "server/retrieval/ranking.h"
#include "server/trust/rival.h"

namespace maploc {
namespace {

// Two answers are one pose if they differ by less.
constexpr double kSameRotationRad = 0.09;  // five degrees
constexpr double kSameSigmas = 10.0;

// When a segment's matches are tried once more as if gravity had not been measured.
enum class AgainstGravity { kNever, kIfInconsistent, kIfNotLocalized };

Ranking Rank(const QueryContext& context, const std::optional<PosePrior>& prior,
             StageTimes& times) {
  const Stopwatch watch(times.retrieval_ms);
  const RetrievalOptions options{
      .max_segments = context.options.max_segments_tried,
      .max_ratio = MaxRatio(context.map.info.point_descriptor),
  };
  return RankSegments(context.view().points, prior, *context.map.places, options);
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

// What the segments of a query that were tried so far leave to the next.
struct Progress {
  explicit Progress(const QueryContext& context) : segments(context) {}

  int iterations = 0;
  int contradicting_inliers = 0;  // most inliers of a pose that contradicts the calibration
  bool is_mirrored = false;       // the photo, as a segment has shown
  TriedSegments segments;
};

int InlierCount(const Evidence& evidence) {
  return evidence.points.inliers + evidence.usable_lines.inliers + evidence.vertical_lines.inliers;
}

// An answer whose pose is not to be told.
Localization Withheld(Localization answer, Outcome why) {
  answer.outcome = why;
  answer.evidence.gravity_rejected = false;
  answer.map_from_body.reset();
  answer.covariance.setZero();
  return answer;
}

// A pose that contradicts the calibration speaks of the camera, and the camera is the same in every
// segment: where fewer inliers leave it open, the contradiction stands.
Localization Weigh(Localization answer, Progress& progress) {
  const int inliers = InlierCount(answer.evidence);
  if (answer.outcome == Outcome::kCalibrationInconsistent) {
    progress.contradicting_inliers = std::max(progress.contradicting_inliers, inliers);
  } else if (answer.outcome == Outcome::kLocalized && inliers < progress.contradicting_inliers) {
    return Withheld(std::move(answer), Outcome::kCalibrationInconsistent);
  }
  return answer;
}

// What the matches of a pose cannot tell: whether the photo itself was mirrored. Asked where much
// is left unexplained, as a mirrored photo leaves it.
Localization UnlessMirrored(const QueryContext& context, const Segment& segment,
                            Localization answer, Progress& progress, StageTimes& times) {
  const FeatureCounts& points = answer.evidence.points;
  if (answer.outcome != Outcome::kLocalized ||
      points.inliers >= kExplainsMost * static_cast<double>(points.matches)) {
    return answer;
  }
  const Stopwatch watch(times.matching_ms);
  progress.is_mirrored = progress.is_mirrored || MatchesBetterMirrored(context.view(), segment);
  if (!progress.is_mirrored) return answer;
  return Withheld(std::move(answer), Outcome::kLowConfidence);
}

// A segment's matches through all that follows; once more without the gravity that was sent where
// that may be what is wrong. Only a LOCALIZED answer is taken from that second attempt.
Result<Localization> TryMatched(const QueryContext& context, const MapSnapshot::Entry& entry,
                                const Matches& matches, AgainstGravity against_gravity,
                                Progress& progress, StageTimes& times) {
  const MatchedProblem matched = MakeProblem(context, *entry.segment, matches);
  const PoseProblem& problem = matched.problem;
  const Localization start = StartAnswer(context, entry, matched);
  MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  // The next best strategies are as dear as an attempt without gravity, and tried where that is.
  const bool fall_back = against_gravity != AgainstGravity::kNever;
  MAPLOC_ASSIGN_OR_RETURN(Localization answer, TryMatches(context, entry, problem, fall_back, start,
                                                          progress.iterations, times));
  answer = UnlessMirrored(context, *entry.segment, std::move(answer), progress, times);
  if (!problem.has_gravity || !IsTried(against_gravity, answer.outcome)) {
    return Weigh(std::move(answer), progress);
  }

  PoseProblem without = problem;
  without.has_gravity = false;
  Result<Localization> free =
      TryMatches(context, entry, without, fall_back, start, progress.iterations, times);
  if (!free.ok() && !IsOutOfTime(free.status())) return free.status();
  if (!free.ok() || free->outcome != Outcome::kLocalized) {
    return Weigh(std::move(answer), progress);
  }
  free->evidence.iterations += answer.evidence.iterations;
  return Weigh(UnlessMirrored(context, *entry.segment, *std::move(free), progress, times),
               progress);
}

Result<Localization> TrySegment(const QueryContext& context, int segment,
                                AgainstGravity against_gravity, Progress& progress,
                                StageTimes& times) {
  MAPLOC_ASSIGN_OR_RETURN(const TriedSegments::Tried* const tried,
                          progress.segments.Search(segment, times));
  return TryMatched(context, tried->entry, tried->search->matches, against_gravity, progress,
                    times);
}

// All ranked segments as one, where each alone was too little. The answer is told as one about the
// segment that holds most of its inliers.
Result<Localization> TryJointly(const QueryContext& context, const std::vector<int>& ranked,
                                Progress& progress, StageTimes& times) {
  std::vector<std::shared_ptr<const Segment>> parts;
  std::vector<SearchedSegment> searched;
  for (const int index : ranked) {
    MAPLOC_ASSIGN_OR_RETURN(const TriedSegments::Tried* const part,
                            progress.segments.Search(index, times));
    parts.push_back(part->entry.segment);
    searched.push_back({parts.back().get(), &*part->search});
    MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  }
  const auto joint = std::make_shared<const Segment>(JoinSegments(parts));
  const MapSnapshot::Entry entry{joint, context.map.decisions[ranked.front()]};
  MAPLOC_ASSIGN_OR_RETURN(Localization answer,
                          TryMatched(context, entry, MatchJointly(searched, *joint),
                                     AgainstGravity::kIfNotLocalized, progress, times));
  TellOfOnePart(*joint, parts, answer);
  return answer;
}

// All ranked segments together, then those after the first alone, until one answers.
Result<Localization> TryBeyondFirst(const QueryContext& context, const std::vector<int>& ranked,
                                    Progress& progress, StageTimes& times) {
  MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  MAPLOC_ASSIGN_OR_RETURN(Localization answer, TryJointly(context, ranked, progress, times));
  for (std::size_t i = 1; i < ranked.size() && answer.outcome != Outcome::kLocalized; ++i) {
    MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
    MAPLOC_ASSIGN_OR_RETURN(
        answer, TrySegment(context, ranked[i], AgainstGravity::kNever, progress, times));
  }
  return answer;
}

// The best ranked segment, then the others, within the query's time. A wrong gravity costs at most
// two more searches: where the first segment's matches contradict it, and where all matches
// together found nothing. If no segment answers, the best ranked segment's answer is returned: a
// query counts in exactly one segment.
Result<Localization> TrySegments(const QueryContext& context, const std::vector<int>& ranked,
                                 Progress& progress, StageTimes& times) {
  MAPLOC_ASSIGN_OR_RETURN(const MapSnapshot::Entry* const best,
                          progress.segments.Load(ranked.front(), times));
  MAPLOC_ASSIGN_OR_RETURN(std::optional<Localization> quick,
                          TryCoarseToFine(context, *best, progress.iterations, times));
  // Beyond a prior, a segment near it may have contradicted the calibration already.
  if (quick) quick = Weigh(*std::move(quick), progress);
  if (quick && quick->outcome == Outcome::kLocalized) return *std::move(quick);
  const bool alone = ranked.size() == 1;
  MAPLOC_ASSIGN_OR_RETURN(Localization first, TrySegment(context, ranked.front(),
                                                         alone ? AgainstGravity::kIfNotLocalized
                                                               : AgainstGravity::kIfInconsistent,
                                                         progress, times));
  if (first.outcome == Outcome::kLocalized || alone) return first;
  Result<Localization> other = TryBeyondFirst(context, ranked, progress, times);
  if (!other.ok() && !IsOutOfTime(other.status())) return other.status();
  return other.ok() && other->outcome == Outcome::kLocalized ? other : first;
}

Localization OutOfMap(const QueryContext& context) {
  Localization answer;
  answer.map = context.map.info.key;
  answer.outcome = Outcome::kOutOfMap;
  if (context.query.requested_strategy) {
    answer.evidence.strategy = *context.query.requested_strategy;
    answer.strategy_source = StrategySource::kRequested;
  }
  return answer;
}

// Whether two answers are one pose: landmarks that were mapped twice give the same pose twice,
// equal rooms do not.
bool AreSamePose(const Localization& a, const Localization& b) {
  const double variance =
      a.covariance.diagonal().head<3>().sum() + b.covariance.diagonal().head<3>().sum();
  return RotationAngleBetween(a.map_from_body->rotation, b.map_from_body->rotation) <
             kSameRotationRad &&
         (a.map_from_body->translation - b.map_from_body->translation).squaredNorm() <
             kSameSigmas * kSameSigmas * variance;
}

// Whoever stands in one of two equal rooms must not be told the other: where a segment looks the
// same as the answer's, it is tried too. The one with clearly more inliers is right; else nobody
// can tell.
Result<Localization> UnlessTwin(const QueryContext& context, const Ranking& ranking,
                                Localization answer, Progress& progress, StageTimes& times) {
  if (answer.outcome != Outcome::kLocalized) return answer;
  const Result<std::vector<int>> twins =
      FindTwins(context, ranking, answer, progress.segments, times);
  if (!twins.ok() && !IsOutOfTime(twins.status())) return twins.status();
  // What could not be compared in time is not told.
  if (!twins.ok()) return Withheld(std::move(answer), Outcome::kLowConfidence);
  for (const int twin : *twins) {
    Result<Localization> other =
        TrySegment(context, twin, AgainstGravity::kIfInconsistent, progress, times);
    if (!other.ok() && !IsOutOfTime(other.status())) return other.status();
    if (!other.ok()) return Withheld(std::move(answer), Outcome::kLowConfidence);
    if (other->outcome != Outcome::kLocalized || AreSamePose(answer, *other)) continue;
    const auto more = static_cast<std::size_t>(InlierCount(other->evidence));
    const auto inliers = static_cast<std::size_t>(InlierCount(answer.evidence));
    if (inliers < InliersOfCloseRival(more)) {
      answer = *std::move(other);
    } else if (more >= InliersOfCloseRival(inliers)) {
      return Withheld(std::move(answer), Outcome::kLowConfidence);
    }
  }
  return answer;
}

// The segments of a ranking, best first; OUT_OF_MAP where there are none.
Result<Localization> TryRanked(const QueryContext& context, const Ranking& ranking,
                               Progress& progress, StageTimes& times) {
  if (ranking.segments.empty()) return OutOfMap(context);
  MAPLOC_ASSIGN_OR_RETURN(Localization answer,
                          TrySegments(context, ranking.segments, progress, times));
  return UnlessTwin(context, ranking, std::move(answer), progress, times);
}

// As if there were no prior, in the segments that it kept out. A prior is a hint: a robot that was
// carried, or whose odometry slipped, is where its picture says.
Result<Localization> TryBeyondPrior(const QueryContext& context, const std::vector<int>& tried,
                                    Progress& progress, StageTimes& times) {
  MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  Ranking ranking = Rank(context, std::nullopt, times);
  std::erase_if(ranking.segments, [&](int segment) {
    return std::find(tried.begin(), tried.end(), segment) != tried.end();
  });
  return TryRanked(context, ranking, progress, times);
}

// Where the prior says, then elsewhere. Where neither answers, what was found near the prior is
// told.
Result<Localization> Search(const QueryContext& context, StageTimes& times) {
  Progress progress(context);
  const Ranking ranking = Rank(context, context.query.prior, times);
  MAPLOC_ASSIGN_OR_RETURN(Localization answer, TryRanked(context, ranking, progress, times));
  if (!context.query.prior || answer.outcome == Outcome::kLocalized) return answer;
  Result<Localization> elsewhere = TryBeyondPrior(context, ranking.segments, progress, times);
  if (!elsewhere.ok() && !IsOutOfTime(elsewhere.status())) return elsewhere.status();
  return elsewhere.ok() && elsewhere->outcome == Outcome::kLocalized ? elsewhere : answer;
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
    const QueryContext context{
        query, map, options, {deadline, cancelled}, options.seed ^ ContentHash(query)};
    MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
    MAPLOC_ASSIGN_OR_RETURN(answer, Search(context, times));
  }
  answer.times = times;
  return answer;
}

}  // namespace maploc
