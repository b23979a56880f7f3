#include "server/pipeline/coarse_to_fine.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "mapstore/geometry/pixel_scale.h"
#include "server/matching/guided_matching.h"
#include "server/matching/segment_matching.h"
#include "server/pipeline/stopwatch.h"

namespace maploc {
namespace {

constexpr int kSampledPoints = 300;
// Fewer points are matched at once.
constexpr std::size_t kWorthSampling = 1000;
// Enough for every test of server/trust. The share of inliers must be above three quarters by two
// standard deviations.
constexpr int kEnoughInliers = 60;
constexpr double kShareSigmas = 2.0;
// Three of four inlier points are found within a few dozen draws. (Of 1P1L only if lines agree,
// too.)
constexpr int kMaxIterations = 200;
// Radius of the guided search in inlier thresholds. Above one, so that the matches are there that a
// truer lens than the sent one would gain (server/trust/calibration.h).
constexpr double kGuidedRadius = 1.5;
// Of the server's threshold. Within a wider one of the query's own, too many landmarks compete.
constexpr double kWidestThreshold = 2.0;

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
  const double radius_px = kGuidedRadius * context.MaxErrorVgaPx() * PixelScale(view.camera);
  const std::vector<FeatureMatch> others =
      MatchNearProjections(view, segment, view.camera_from_body * coarse.map_from_body->Inverse(),
                           radius_px, coarse.matches.points, coarse.point_match_inlier);
  Matches all = coarse.matches;
  all.points.insert(all.points.end(), others.begin(), others.end());
  return MakeProblem(context, segment, all);
}

double SampledShare(std::size_t points) { return kSampledPoints / static_cast<double>(points); }

bool IsSure(const Localization& answer) {
  const FeatureCounts& points = answer.evidence.points;
  const double matches = points.matches;
  const double least = kExplainsMost * matches +
                       kShareSigmas * std::sqrt(kExplainsMost * (1.0 - kExplainsMost) * matches);
  return answer.outcome == Outcome::kLocalized && !answer.evidence.gravity_rejected &&
         points.inliers >= std::max<double>(kEnoughInliers, least);
}

// What the sample says of the final pose.
void CountSample(const Localization& coarse, Localization& fine) {
  // The sample's matches come first (MatchGuided). None of them was dropped since, because the
  // camera could see each one before.
  const auto sample_end = fine.point_match_inlier.begin() + std::ssize(coarse.matches.points);
  fine.evidence.points = {
      .matches = coarse.evidence.points.matches,
      .inliers = std::accumulate(fine.point_match_inlier.begin(), sample_end, std::int32_t{0})};
  // What was looked for near the sample's pose agrees with it anyway, and must not raise the
  // confidence.
  fine.evidence.confidence = std::min(fine.evidence.confidence, coarse.evidence.confidence);
}

// Statistics add this to what full searches count.
Localization WithEvidenceOfAll(Localization answer, std::size_t points) {
  const double times = 1.0 / SampledShare(points);
  for (std::int32_t* count : {&answer.evidence.points.matches, &answer.evidence.points.inliers}) {
    *count = static_cast<std::int32_t>(std::lround(*count * times));
  }
  return answer;
}

}  // namespace

Result<std::optional<Localization>> TryCoarseToFine(const QueryContext& context,
                                                    const MapSnapshot::Entry& entry,
                                                    int& iterations, StageTimes& times) {
  const std::size_t points = context.view().points.keypoints_px.size();
  if (points < kWorthSampling ||
      context.MaxErrorVgaPx() > kWidestThreshold * context.options.max_reprojection_error_px) {
    return std::optional<Localization>();
  }
  const MatchedProblem sample = MatchSampled(context, *entry.segment, times);
  MAPLOC_RETURN_IF_ERROR(context.interrupt.Check());
  MAPLOC_ASSIGN_OR_RETURN(
      const Localization coarse,
      TrySample(context, entry, sample, SampledShare(points), kMaxIterations, iterations, times));
  if (!IsSure(coarse)) return std::optional<Localization>();

  const MatchedProblem all = MatchGuided(context, *entry.segment, coarse, times);
  Result<Localization> fine = RefineKnown(context, entry, all, coarse, times);
  if (!fine.ok()) {
    if (!IsOutOfTime(fine.status())) return fine.status();
    return std::optional(WithEvidenceOfAll(coarse, points));
  }
  CountSample(coarse, *fine);
  if (!IsSure(*fine)) return std::optional<Localization>();
  return std::optional(WithEvidenceOfAll(*std::move(fine), points));
}

}  // namespace maploc
