#include "mapstore/store/derivation.h"

#include <algorithm>
#include <tuple>

#include "mapstore/geometry/line.h"

namespace maploc {

void LandmarkCounter::Add(const Segment& segment) {
  ++segments_;
  points_.insert(segment.points.ids.begin(), segment.points.ids.end());
  for (std::size_t i = 0; i < segment.lines.ids.size(); ++i) {
    lines_.insert(segment.lines.ids[i]);
    if (IsUsableLine(segment.lines.segments_in_map[i])) usable_lines_.insert(segment.lines.ids[i]);
  }
}

void LandmarkCounter::CountInto(MapSummary& summary) const {
  summary.segments = segments_;
  summary.points = static_cast<std::int64_t>(points_.size());
  summary.lines = static_cast<std::int64_t>(lines_.size());
  summary.usable_lines = static_cast<std::int64_t>(usable_lines_.size());
}

void InsertInFoldingOrder(const SegmentSessionRow& row, std::vector<SegmentSessionRow>& rows) {
  const auto before = [](const SegmentSessionRow& a, const SegmentSessionRow& b) {
    return std::tie(a.session_start_unix_ns, a.session) <
           std::tie(b.session_start_unix_ns, b.session);
  };
  rows.insert(std::upper_bound(rows.begin(), rows.end(), row, before), row);
}

SegmentDerivation DeriveSegment(std::span<const SegmentSessionRow> rows,
                                const std::optional<Strategy>& pinned,
                                const SelectorOptions& options) {
  SegmentDerivation derived{Aggregate(rows, options.statistics), SelectStrategy(rows, options)};
  if (!pinned) return derived;
  const StrategyPrediction prediction = PredictStrategies(derived.statistics, options);
  derived.decision = {*pinned, StrategySource::kPinned,
                      "pinned by an operator; otherwise " + derived.decision.reason,
                      derived.statistics.localized > 0 ? prediction.ProbabilityOf(*pinned) : 0.0,
                      RankAfter(*pinned, derived.decision.ranking)};
  return derived;
}

SessionSummary SummarizeSession(const SessionId& id, SessionEnd end,
                                std::span<const Observation> observations,
                                std::span<const SegmentSessionRow> rows) {
  SessionSummary summary;
  summary.session = id;
  summary.end = end;
  summary.queries = static_cast<std::int64_t>(observations.size());
  summary.localized =
      std::count_if(observations.begin(), observations.end(),
                    [](const Observation& o) { return o.outcome == Outcome::kLocalized; });
  for (const SegmentSessionRow& row : rows) {
    summary.segments.push_back(
        {row.segment, row.queries, row.localized, Strategy::kMixed, Strategy::kMixed});
  }
  return summary;
}

}  // namespace maploc
