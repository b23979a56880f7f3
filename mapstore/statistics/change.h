// When did a segment change, and in what? (README.md, "Change" and "Since when")
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "mapstore/model/session.h"
#include "mapstore/statistics/statistics_options.h"

namespace maploc {

// A share `good / total` that is worth no more than `independent` independent trials.
struct Proportion {
  double good = 0.0;
  double total = 0.0;
  double independent = 0.0;
  bool operator==(const Proportion&) const = default;
};

// Whether the share of `fresh` lies outside the 99% interval that `old` predicts for it: the
// scatter of both counts together, about Jeffreys' mean (half a good and half a bad one added), so
// that a spotless record does not predict perfection. False where either is empty.
bool IsChanged(const Proportion& old, const Proportion& fresh);

// Sums of shares; `independent` adds up what each is worth by itself.
void AddTo(Proportion& sum, const Proportion& share);

// What may change: the inlier ratio of points, that of all lines, the share of localized queries.
enum class ChangeKind { kPoints = 1, kLines = 2, kSuccess = 3 };
inline constexpr std::array kChangeKinds = {ChangeKind::kPoints, ChangeKind::kLines,
                                            ChangeKind::kSuccess};
std::string_view ChangeKindName(ChangeKind kind);  // "points", "lines", "success"

// The right ones of the matches that a session's localized queries have together.
Proportion InliersOf(std::int64_t inliers, std::int64_t matches, std::int64_t localized,
                     const StatisticsOptions& options);

// What one session says about a kind.
Proportion ProportionOf(ChangeKind kind, const SegmentSessionRow& row,
                        const StatisticsOptions& options);

// The level of a kind since a session, and the level of the sessions before (since the change
// before this one).
struct ChangePoint {
  ChangeKind kind = ChangeKind::kPoints;
  SessionId since;
  std::int64_t since_unix_ns = 0;
  std::int64_t sessions = 0;  // from `since` on
  double before = 0.0;
  double after = 0.0;
  double deviation = 0.0;  // of the two, in standard deviations; negative where it fell
};

// The last change of each kind, ascending by kind; kinds without one are left out. A change is the
// split of the sessions whose two sides differ most, by four standard deviations or more (under 1%
// of false alarms over 150 sessions), and then that of the later side, until none is left. Sessions
// are not weighted by age. REQUIRES: rows in the order (session_start_unix_ns, session).
std::vector<ChangePoint> FindChanges(std::span<const SegmentSessionRow> rows,
                                     const StatisticsOptions& options = {});

}  // namespace maploc
