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

// Sums of shares; `independent` adds up what each is worth by itself.
void AddTo(Proportion& sum, const Proportion& share);

// The share that some sessions have together. A session counts less than one where it is old.
struct SessionShares {
  Proportion share;
  double sessions = 0.0;
  bool operator==(const SessionShares&) const = default;
};

void AddTo(SessionShares& sum, const Proportion& share);  // of one session

// How much sessions differ beyond their counting errors, from one day to the next: as a share of
// the largest variance that a mean m can have, m (1 - m) (the intraclass correlation of a
// beta-binomial model). A weighted mean over sessions.
struct Scatter {
  double sum = 0.0;
  double weight = 0.0;  // one for a session with many queries, less for one with few

  // In [0, 1]. What is assumed without sessions counts as four of them.
  double Value() const;
  // Takes in a session that `old` does not contain yet. A surprising one counts only as far as
  // IsChanged tolerates, so that a true change is not taken for scatter, but repeated surprises
  // are. No effect where either has no trials.
  void Add(const SessionShares& old, const Proportion& fresh);
  bool operator==(const Scatter&) const = default;
};

// `after` minus `before` in standard deviations: of both counts and of their sessions' scatter,
// about Jeffreys' mean of both (half a good and half a bad trial added), so that a record without
// a failure does not predict perfection. 0 where either has no trials.
double Deviation(const SessionShares& before, const SessionShares& after, double scatter);

// Whether a session's share lies outside the 99.9% interval that the sessions before predict.
bool IsChanged(const SessionShares& old, const Proportion& fresh, const Scatter& scatter);

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
// split of the sessions whose two sides differ most, by 4.3 standard deviations or more (under 1%
// of false alarms over 100 sessions), and then that of the later side, until none is left. Sessions
// are not weighted by age. REQUIRES: rows in the order (session_start_unix_ns, session).
std::vector<ChangePoint> FindChanges(std::span<const SegmentSessionRow> rows,
                                     const StatisticsOptions& options = {});

}  // namespace maploc
