// One segment's matches through RANSAC, refinement and judgement, with the segment's strategy and,
// where that finds nothing, the next best ones.
#pragma once

#include <cstdint>

#include "mapstore/base/status.h"
#include "mapstore/geometry/pixel_scale.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/matches.h"
#include "mapstore/model/query.h"
#include "server/matching/pose_problem.h"
#include "server/pipeline/interrupt.h"
#include "server/pipeline/localizer.h"
#include "server/pipeline/map_snapshot.h"

namespace maploc {

// What stays the same while one query walks through its segments.
struct QueryContext {
  const Query& query;
  const MapSnapshot& map;
  const LocalizerOptions& options;
  Interrupt interrupt;
  std::uint64_t seed;

  const View& view() const { return query.views.front(); }
  // The inlier threshold in pixels of a VGA-sized image, as the problem counts them.
  double MaxErrorVgaPx() const {
    if (!query.max_error_px) return options.max_reprojection_error_px;
    return *query.max_error_px / PixelScale(view().camera);
  }
};

// Hypotheses without gravity, tried after those with a wrong gravity failed. Enough if a sixth of
// the matches are right, and cheap enough for every query without an answer.
inline constexpr int kIterationsAgainstGravity = 2000;

// Of the points' matches: what leaves more unexplained may be a mirrored photo. Honest photos of a
// symmetric front, day and dusk: 0.79 at least; mirrored ones 0.3 to 0.64 (`reichstag`).
inline constexpr double kExplainsMost = 0.75;

// The one that was asked for, else the segment's.
Strategy ChooseStrategy(const QueryContext& context, const StrategyDecision& decision);

// Tries a segment's matches with its strategy, and with the next best ones (`fall_back`), until one
// is LOCALIZED; otherwise the most confident answer is returned (of equals the first), with the
// iterations of all. `start` is the answer before there is a pose. `iterations` and `times` add up
// over all attempts of a query. An error if the query is interrupted before any strategy has ended.
Result<Localization> TryMatches(const QueryContext& context, const MapSnapshot::Entry& entry,
                                const PoseProblem& problem, bool fall_back,
                                const Localization& start, int& iterations, StageTimes& times);

// The geometric problem of `matches` with `segment`, as this map and query pose it.
MatchedProblem MakeProblem(const QueryContext& context, const Segment& segment,
                           const Matches& matches);

// An answer about `entry`'s segment with its matches, without a pose as yet (TOO_FEW_MATCHES).
Localization StartAnswer(const QueryContext& context, const MapSnapshot::Entry& entry,
                         const MatchedProblem& matched);

// The matches of `sampled_share` of the points, by the first strategy alone, within
// `max_iterations`. `iterations` and `times` add up as above.
Result<Localization> TrySample(const QueryContext& context, const MapSnapshot::Entry& entry,
                               const MatchedProblem& matched, double sampled_share,
                               int max_iterations, int& iterations, StageTimes& times);

// Refines and judges the pose of `known`, which is LOCALIZED, with all of `matched` instead of the
// matches that it was found with. Strategy and iterations stay `known`'s.
Result<Localization> RefineKnown(const QueryContext& context, const MapSnapshot::Entry& entry,
                                 const MatchedProblem& matched, const Localization& known,
                                 StageTimes& times);

}  // namespace maploc
