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
};

// Puts a new row where it belongs among the older ones: by start, then session.
void InsertInFoldingOrder(const SegmentSessionRow& row, std::vector<SegmentSessionRow>& rows);

// REQUIRES: rows in folding order. A pin overrules the selector, whose choice its reason tells.
SegmentDerivation DeriveSegment(std::span<const SegmentSessionRow> rows,
                                const std::optional<Strategy>& pinned,
                                const SelectorOptions& options);

// The summary of a session but for its segments' strategies (filled in by the caller, one a row).
SessionSummary SummarizeSession(const SessionId& id, SessionEnd end,
                                std::span<const Observation> observations,
                                std::span<const SegmentSessionRow> rows);

}  // namespace maploc
