// Which strategy a segment should use (paper section IV, design.md section 6).
#pragma once

#include <array>
#include <span>

#include "mapstore/model/session.h"
#include "mapstore/statistics/statistics.h"

namespace maploc {

// Probability that one draw is all inliers. Each in [0, 1], and 0 where it cannot be drawn.
struct DrawProbabilities {
  double p1p1l = 0.0;  // lambda gamma
  double p2p = 0.0;    // lambda (lambda p - 1) / (p - 1)
  double mixed = 0.0;  // lambda (lambda p + gamma l - 1) / (p + l - 1)
};

// p, l: point and usable-line matches of a query; lambda, gamma: their inlier rates. A draw needs
// its features: 1P1L p >= 1 and l >= 1; 2P p >= 2; mixed p >= 1 and p + l >= 2.
DrawProbabilities ComputeDrawProbabilities(double p, double l, double lambda, double gamma);

// How the selector compares strategies.
enum class StrategyCriterion {
  kExpectedTime = 1,  // least time to success
  kPaper = 2,         // gamma >= lambda: 1P1L, else 2P
};

// What becomes of a draw, by what it draws: the sampler's gates refuse degenerate samples, and a
// sample without a valid solution is drawn again and is no iteration.
struct SampleYield {
  double good = 1.0;  // share of all-inlier draws that are evaluated and lead to the pose
  double bad = 1.0;   // share of the other draws that are evaluated
  bool operator==(const SampleYield&) const = default;
};

struct SelectorOptions {
  StatisticsOptions statistics;
  StrategyCriterion criterion = StrategyCriterion::kExpectedTime;
  // Evidence before the strategy leaves "mixed": localized queries, weighted by age.
  std::int64_t min_localized_queries = 10;
  double prior_matches = 10.0;      // weak Beta prior: this many matches ...
  double prior_inlier_ratio = 0.3;  // ... at this rate
  double hysteresis =
      0.15;  // a new strategy must beat the current one's expected time to success by this share
  std::int64_t max_iterations = 10000;  // of a query, then it fails; positive
  SampleYield two_points;
  SampleYield point_and_line;
  SampleYield point_and_verticals;
  // Nanoseconds of one iteration (solve and score) of each strategy, relative figures suffice.
  double cost_1p1l = 1.0;
  double cost_2p = 1.0;
  double cost_mixed = 1.0;
  bool operator==(const SelectorOptions&) const = default;
};

// What the selector compares. Times are cost / probability, in the unit of the costs; infinite for
// what cannot succeed.
struct StrategyPrediction {
  double point_inlier_ratio = 0.0;        // lambda: posterior mean
  double usable_line_inlier_ratio = 0.0;  // gamma: posterior mean
  double point_matches = 0.0;             // p
  double usable_line_matches = 0.0;       // l
  DrawProbabilities draw;

  // REQUIRES: strategy is 1P1L, 2P or mixed.
  double ProbabilityOf(Strategy strategy) const;
  double ExpectedTimeOf(Strategy strategy, const SelectorOptions& options) const;
};

StrategyPrediction PredictStrategies(const SegmentStatistics& statistics,
                                     const SelectorOptions& options = {});

// `ranking` with `first` moved to its front. REQUIRES: it is in there.
std::array<Strategy, 3> RankAfter(Strategy first, std::array<Strategy, 3> ranking);

// The decision after all rows, replayed from the first (hysteresis folds over the same order).
// Pure: the same rows give the same decision. REQUIRES: rows in the order (session_start_unix_ns,
// session).
StrategyDecision SelectStrategy(std::span<const SegmentSessionRow> rows,
                                const SelectorOptions& options = {});

}  // namespace maploc
