#include "server/pipeline/coarse_to_fine.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "mapstore/geometry/pixel_scale.h"
#include "server/matching/guided_matching.h"
#include "server/matching/pose_problem.h"
#include "server/matching/segment_matching.h"
#include "server/pipeline/stopwatch.h"

namespace maploc {
namespace {

constexpr int kSampledPoints = 250;
// Fewer points than so many samples are matched at once.
constexpr int kWorthSampling = 4;
// A pose that the sample determines well enough to look near it, and to judge by it.
constexpr int kEnoughInliers = 50;

MatchedProblem MakeProblem(const QueryContext& context, const Segment& segment,
                           const Matches& matches) {
  MatchedProblem matched =
      BuildPoseProblem(matches, context.view(), segment, context.query.gravity);
  matched.problem.shared_error_rad = context.map.info.shared_error_rad;
  return matched;
}

MatchedProblem MatchSampled(const QueryContext& context, const Segment& segment,
                            StageTimes& times) {
  const Stopwatch watch(times.matching_ms);
  return MakeProblem(context, segment, MatchSample(context.view(), segment, kSampledPoints));
}

// The sample's matches, and after them those of the other points near `coarse`'s pose.
MatchedProblem MatchGuided(const QueryContext& context, const Segment& segment,
                           const Localization& coarse, StageTimes& times) {
  const Stopwatch watch(times.matching_ms);
  const View& view = context.view();
  const std::vector<FeatureMatch> others =
      MatchNearProjections(view, segment, view.camera_from_body * coarse.map_from_body->Inverse(),
                           context.MaxErrorVgaPx() * PixelScale(view.camera), coarse.matches.points,
                           coarse.point_match_inlier);
  Matches all = coarse.matches;
  all.points.insert(all.points.end(), others.begin(), others.end());
  return MakeProblem(context, segment, all);
}

bool IsSure(const Localization& answer) {
  return answer.outcome == Outcome::kLocalized &&
         answer.evidence.points.inliers >= kEnoughInliers && ExplainsMost(answer.evidence);
}

// What the sample says for the final pose.
Localization WithEvidenceOf(const Localization& coarse, Localization fine) {
  const auto sampled_end = fine.point_match_inlier.begin() + std::ssize(coarse.matches.points);
  fine.evidence.points = {
      .matches = static_cast<std::int32_t>(coarse.matches.points.size()),
      .inliers = std::accumulate(fine.point_match_inlier.begin(), sampled_end, std::int32_t{0})};
  fine.evidence.confidence = std::min(fine.evidence.confidence, coarse.evidence.confidence);
  return fine;
}

}  // namespace

Result<std::optional<Localization>> TryCoarseToFine(const QueryContext& context,
                                                    const MapSnapshot::Entry& entry,
                                                    int& iterations, StageTimes& times) {
  const std::size_t points = context.view().points.keypoints_px.size();
  if (points < kWorthSampling * kSampledPoints) return std::optional<Localization>();
  const MatchedProblem sample = MatchSampled(context, *entry.segment, times);
  MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  MAPLOC_ASSIGN_OR_RETURN(const Localization coarse,
                          TryMatches(context, entry, sample.problem, /*fall_back=*/false,
                                     StartAnswer(context, entry, sample), iterations, times));
  if (!IsSure(coarse)) return std::optional<Localization>();

  const MatchedProblem all = MatchGuided(context, *entry.segment, coarse, times);
  MAPLOC_ASSIGN_OR_RETURN(Localization fine, RefineKnown(context, entry, all.problem, coarse,
                                                         StartAnswer(context, entry, all), times));
  if (fine.outcome != Outcome::kLocalized) return std::optional<Localization>();
  return std::optional(WithEvidenceOf(coarse, std::move(fine)));
}

}  // namespace maploc
