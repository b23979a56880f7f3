// What every store derives from what it keeps: counts of distinct landmarks, statistics, strategies
// and a session's summary.
#pragma once

#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "mapstore/model/map.h"
#include "mapstore/model/session.h"
#include "mapstore/statistics/selector.h"
#include "mapstore/store/map_store.h"

namespace maploc {

// Counts distinct landmarks while segments come in; a landmark in two segments counts once.
class LandmarkCounter {
 public:
  void Add(const Segment& segment);
  // Fills points, lines, usable_lines and segments.
  void CountInto(MapSummary& summary) const;

 private:
  std::int64_t segments_ = 0;
  std::unordered_set<LandmarkId> points_;
  std::unordered_set<LandmarkId> lines_;
  std::unordered_set<LandmarkId> usable_lines_;
};

// What the rows of a segment say: its statistics, and the strategy in force.
struct SegmentDerivation {
  SegmentStatistics statistics;
  StrategyDecision decision;
  bool operator==(const SegmentDerivation&) const = default;
};

// An operator's decision about a segment's strategy.
struct Pin {
  std::int64_t time_unix_ns = 0;
  std::optional<Strategy> strategy;  // nullopt: given back to the selector
};

// The source data of a segment. Everything that a store reports about the segment is a function of
// this value. So neither the order in which sessions ended nor a revoked session has an effect.
struct SegmentTruth {
  std::vector<SegmentSessionRow> rows;     // of unrevoked sessions, in folding order
  std::vector<std::int64_t> ends_unix_ns;  // of their sessions, one a row
  std::vector<Pin> pins;                   // in the order in which they were given
  SelectorOptions options;  // of the newest row; without rows of the last pin; else the reader's
};

// What is in force for a segment.
struct SegmentState {
  SegmentDerivation derived;
  std::optional<Strategy> pinned;
  SelectorOptions options;
  bool operator==(const SegmentState&) const = default;
};

// A pin overrides the selector; its reason then names the selector's choice. `fold`: of all rows,
// with `options`.
SegmentState StateOf(const SelectorFold& fold, const SelectorOptions& options,
                     const std::optional<Strategy>& pinned);
SegmentState DeriveState(const SegmentTruth& truth);

// The history of decisions as if every session had ended in the order of their starts: one decision
// per row and one per pin. A pin comes after the sessions that started before it. The last decision
// is in force.
std::vector<DecisionRecord> ReplayHistory(const SegmentTruth& truth);

// A hash of what the derivation makes of rows that never change, own and inherited ones. A store
// keeps it: where it differs (another version of the selector, another compiler) statistics and
// strategies are derived anew.
std::int64_t DerivationFingerprint();

// The summary of a session but for its segments' strategies (filled in by the caller, one a row).
SessionSummary SummarizeSession(const SessionId& id, SessionEnd end,
                                std::span<const Observation> observations,
                                std::span<const SegmentSessionRow> rows);

}  // namespace maploc
