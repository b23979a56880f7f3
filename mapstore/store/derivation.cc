#include "mapstore/store/derivation.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>

#include "mapstore/base/random.h"
#include "mapstore/geometry/line.h"
#include "mapstore/store/carried.h"

namespace maploc {
namespace {

// Sessions of a season: points fade while lines stay, then they come back, so that strategies
// change. Never edit these rows: every store would take the change for another derivation and
// derive all its states again.
std::vector<SegmentSessionRow> SampleRows() {
  std::vector<SegmentSessionRow> rows;
  for (std::int64_t i = 0; i < 24; ++i) {
    SegmentSessionRow row;
    row.session = "sample" + std::to_string(100 + i);
    row.session_start_unix_ns = i;
    row.queries = 7 + i % 5;
    row.localized = row.queries - i % 3;
    row.point_matches = row.localized * (90 + i);
    row.point_inliers = row.point_matches * (8 <= i && i < 16 ? 5 : 60) / 100;
    row.usable_line_matches = row.localized * 20;
    row.usable_line_inliers = row.usable_line_matches * (30 + i % 4) / 100;
    row.vertical_line_matches = row.localized * 6;
    row.vertical_line_inliers = row.vertical_line_matches / 2;
    row.median_point_matches = 90.0 + static_cast<double>(i);
    row.median_usable_line_matches = 20.0;
    row.median_vertical_line_matches = 6.0;
    rows.push_back(row);
  }
  return rows;
}

// The sample as two segments of an older version, one of which lives on in part only, and what
// segment 0 of two heirs makes of it. Never to be edited either.
std::vector<SegmentSessionRow> CarriedSampleRows() {
  const std::array inheritance = {Inheritance{1, 0, 0, 0.55}, Inheritance{1, 1, 0, 1.0 / 3.0},
                                  Inheritance{1, 0, 1, 0.25}, Inheritance{1, 1, 1, 2.0 / 3.0}};
  std::vector<TrueRow> older;
  for (const SegmentSessionRow& row : SampleRows()) {
    for (SegmentId segment = 0; segment < 2; ++segment) {
      older.push_back({row, 1, 0, 0});
      older.back().row.segment = segment;
      older.back().row.median_point_matches += 3.0 * segment;
    }
  }
  std::vector<SegmentSessionRow> carried;
  for (TrueRow& row : WithInherited(0, {}, older, inheritance)) {
    carried.push_back(std::move(row.row));
  }
  return carried;
}

// Bytes of all that the derivation makes of the rows.
std::string BytesOfDerivation(std::vector<SegmentSessionRow> rows) {
  SegmentTruth truth;
  truth.rows = std::move(rows);
  truth.ends_unix_ns.resize(truth.rows.size());
  std::string bytes;
  for (const DecisionRecord& record : ReplayHistory(truth)) {
    const SegmentStatistics& sums = record.statistics;
    const std::array numbers = {static_cast<double>(sums.queries),
                                static_cast<double>(sums.localized),
                                sums.point_matches,
                                sums.point_inliers,
                                sums.usable_line_inliers,
                                sums.vertical_line_inliers,
                                sums.weighted_queries,
                                sums.weighted_localized,
                                sums.independent_points,
                                sums.independent_usable_lines,
                                sums.independent_vertical_lines,
                                sums.typical_point_matches,
                                sums.typical_usable_line_matches,
                                sums.typical_vertical_line_matches,
                                record.decision.predicted_success};
    // The exact bits: results are promised to be bit-identical, so a compiler that rounds otherwise
    // counts as another derivation.
    bytes.append(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
    for (const Strategy strategy : record.decision.ranking) bytes += StrategyName(strategy);
    bytes += record.decision.reason;
  }
  return bytes;
}

SegmentDerivation DeriveFrom(const SelectorFold& fold, const std::optional<Strategy>& pinned) {
  SegmentDerivation derived{fold.statistics().Value(), fold.Decision()};
  if (!pinned) return derived;
  const bool evidence = derived.statistics.localized > 0;
  derived.decision = {*pinned, StrategySource::kPinned,
                      "pinned by an operator; otherwise " + derived.decision.reason,
                      evidence ? fold.prediction().Of(*pinned).iteration_probability : 0.0,
                      RankAfter(*pinned, derived.decision.ranking)};
  return derived;
}

}  // namespace

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

SegmentState StateOf(const SelectorFold& fold, const SelectorOptions& options,
                     const std::optional<Strategy>& pinned) {
  return {DeriveFrom(fold, pinned), pinned, options};
}

SegmentState DeriveState(const SegmentTruth& truth) {
  SelectorFold fold(truth.options);
  for (const SegmentSessionRow& row : truth.rows) fold.Add(row);
  return StateOf(fold, truth.options,
                 truth.pins.empty() ? std::nullopt : truth.pins.back().strategy);
}

std::vector<DecisionRecord> ReplayHistory(const SegmentTruth& truth) {
  std::vector<DecisionRecord> history;
  SelectorFold fold(truth.options);
  std::optional<Strategy> pinned;
  std::size_t next_pin = 0;
  const auto record = [&](std::int64_t time_unix_ns, std::string cause) {
    SegmentDerivation derived = DeriveFrom(fold, pinned);
    history.push_back(
        {time_unix_ns, std::move(cause), std::move(derived.decision), derived.statistics});
  };
  const auto give_pins_before = [&](std::int64_t start_unix_ns) {
    for (; next_pin < truth.pins.size(); ++next_pin) {
      const Pin& pin = truth.pins[next_pin];
      if (pin.time_unix_ns >= start_unix_ns) return;
      pinned = pin.strategy;
      record(pin.time_unix_ns, pinned ? "pin" : "unpin");
    }
  };
  for (std::size_t i = 0; i < truth.rows.size(); ++i) {
    give_pins_before(truth.rows[i].session_start_unix_ns);
    fold.Add(truth.rows[i]);
    record(truth.ends_unix_ns[i], truth.rows[i].session);
  }
  give_pins_before(std::numeric_limits<std::int64_t>::max());
  return history;
}

std::int64_t DerivationFingerprint() {
  static const auto fingerprint = static_cast<std::int64_t>(
      HashBytes(BytesOfDerivation(SampleRows()) + BytesOfDerivation(CarriedSampleRows())));
  return fingerprint;
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
    // Both strategies are placeholders. The caller knows them only after the rows have been folded.
    summary.segments.push_back(
        {row.segment, row.queries, row.localized, Strategy::kMixed, Strategy::kMixed});
  }
  return summary;
}

}  // namespace maploc
