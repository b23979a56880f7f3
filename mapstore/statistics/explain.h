// Why a segment uses its strategy: the selector's arithmetic, laid open. Pure functions.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "mapstore/statistics/change.h"
#include "mapstore/statistics/selector.h"

namespace maploc {

// A rate's posterior, with the counts it comes from.
struct ExplainedRate {
  double good = 0.0;         // inliers, or localized queries; weighted by age
  double total = 0.0;        // matches, or queries
  double independent = 0.0;  // trials that these are worth
  BetaDistribution posterior;
  Interval credible_95;
};

struct Explanation {
  SelectorOptions options;
  StrategyDecision decision;  // in force
  SegmentStatistics statistics;
  bool has_evidence = false;
  ExplainedRate points;          // lambda
  ExplainedRate usable_lines;    // gamma
  ExplainedRate vertical_lines;  // gamma_v
  ExplainedRate success;         // share of localized queries; Jeffreys' prior
  StrategyPrediction prediction;
  // What the selector would choose without hysteresis, and how much faster it is than what the
  // selector keeps or takes, as a share: 0 where it is the same.
  Strategy best = Strategy::kMixed;
  double gain_of_best = 0.0;
  std::vector<StrategySwitch> switches;  // replayed; by sessions alone
  std::vector<ChangePoint> changes;
};

// `in_force` may be a pin; all else is derived from the rows. REQUIRES: rows in the order
// (session_start_unix_ns, session).
Explanation ExplainStrategy(std::span<const SegmentSessionRow> rows,
                            const StrategyDecision& in_force, const SelectorOptions& options);

// For a terminal: several lines, without the store's history of decisions.
std::string ExplanationText(const Explanation& explanation);

}  // namespace maploc
