#include "mapstore/statistics/change.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mapstore/base/median.h"

namespace maploc {
namespace {

constexpr double kZ99 = 2.5758293035489004;  // two-sided 99% of the normal distribution
constexpr double kMinSplitDeviation = 4.0;

double Number(std::int64_t count) { return static_cast<double>(count); }

double Trials(const Proportion& share) { return std::min(share.total, share.independent); }

// Sums of the first n sessions' shares, n from 0.
std::vector<Proportion> PrefixSums(ChangeKind kind, std::span<const SegmentSessionRow> rows,
                                   const StatisticsOptions& options) {
  std::vector<Proportion> sums(1);
  for (const SegmentSessionRow& row : rows) {
    sums.push_back(sums.back());
    AddTo(sums.back(), ProportionOf(kind, row, options));
  }
  return sums;
}

Proportion Between(const std::vector<Proportion>& sums, std::size_t begin, std::size_t end) {
  return {sums[end].good - sums[begin].good, sums[end].total - sums[begin].total,
          sums[end].independent - sums[begin].independent};
}

// Variance of a session's share beside its neighbours', by the median of their squared differences:
// the few that straddle a change hardly move it. The expected square is twice the variance, the
// median 0.455 of the expected one (chi-square of one degree of freedom).
double SessionScatter(ChangeKind kind, std::span<const SegmentSessionRow> rows,
                      const StatisticsOptions& options) {
  std::vector<double> squares;
  std::optional<double> previous;
  for (const SegmentSessionRow& row : rows) {
    const Proportion share = ProportionOf(kind, row, options);
    if (Trials(share) <= 0.0) continue;
    const double ratio = share.good / share.total;
    if (previous) squares.push_back((ratio - *previous) * (ratio - *previous));
    previous = ratio;
  }
  if (squares.empty()) return 0.0;
  return UpperMedian(std::move(squares)) / (2.0 * 0.455);
}

// The sessions from `begin` to `at` against those from there to `end`, in standard deviations: of
// the counts about the mean of both (Jeffreys'), or of the sessions' scatter, whichever is larger.
double DeviationBetween(const std::vector<Proportion>& sums, std::size_t begin, std::size_t at,
                        std::size_t end, double scatter) {
  const Proportion before = Between(sums, begin, at);
  const Proportion after = Between(sums, at, end);
  const double n = Trials(before);
  const double m = Trials(after);
  if (n <= 0.0 || m <= 0.0) return 0.0;
  const double low = before.good / before.total;
  const double high = after.good / after.total;
  const double mean = (low * n + high * m + 0.5) / (n + m + 1.0);
  const double of_counts = mean * (1.0 - mean) * (1.0 / n + 1.0 / m);
  const double of_sessions =
      scatter * (1.0 / static_cast<double>(at - begin) + 1.0 / static_cast<double>(end - at));
  return (high - low) / std::sqrt(std::max(of_counts, of_sessions));
}

struct Split {
  std::size_t at = 0;
  double deviation = 0.0;
};

Split BestSplit(const std::vector<Proportion>& sums, std::size_t begin, std::size_t end,
                double scatter) {
  Split best;
  for (std::size_t at = begin + 1; at < end; ++at) {
    const double deviation = DeviationBetween(sums, begin, at, end, scatter);
    if (std::abs(deviation) > std::abs(best.deviation)) best = {at, deviation};
  }
  return best;
}

std::optional<ChangePoint> LastChange(ChangeKind kind, std::span<const SegmentSessionRow> rows,
                                      const StatisticsOptions& options) {
  const std::vector<Proportion> sums = PrefixSums(kind, rows, options);
  const double scatter = SessionScatter(kind, rows, options);
  std::optional<ChangePoint> change;
  std::size_t begin = 0;
  while (true) {
    const Split split = BestSplit(sums, begin, rows.size(), scatter);
    if (std::abs(split.deviation) < kMinSplitDeviation) return change;
    const Proportion before = Between(sums, begin, split.at);
    const Proportion after = Between(sums, split.at, rows.size());
    change = {kind,
              rows[split.at].session,
              rows[split.at].session_start_unix_ns,
              static_cast<std::int64_t>(rows.size() - split.at),
              before.good / before.total,
              after.good / after.total,
              split.deviation};
    begin = split.at;
  }
}

}  // namespace

bool IsChanged(const Proportion& old, const Proportion& fresh) {
  const double old_count = Trials(old);
  const double count = Trials(fresh);
  if (old_count <= 0.0 || count <= 0.0) return false;
  const double mean = (old.good / old.total * old_count + 0.5) / (old_count + 1.0);
  const double variance = mean * (1.0 - mean) * (1.0 / old_count + 1.0 / count);
  return std::abs(fresh.good / fresh.total - mean) > kZ99 * std::sqrt(variance);
}

void AddTo(Proportion& sum, const Proportion& share) {
  sum.good += share.good;
  sum.total += share.total;
  sum.independent += Trials(share);
}

std::string_view ChangeKindName(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kPoints:
      return "points";
    case ChangeKind::kLines:
      return "lines";
    case ChangeKind::kSuccess:
      return "success";
  }
  return "unknown";
}

Proportion InliersOf(std::int64_t inliers, std::int64_t matches, std::int64_t localized,
                     const StatisticsOptions& options) {
  return {Number(inliers), Number(matches),
          IndependentQueries(localized, options) * options.independent_matches_per_query};
}

Proportion ProportionOf(ChangeKind kind, const SegmentSessionRow& row,
                        const StatisticsOptions& options) {
  switch (kind) {
    case ChangeKind::kPoints:
      return InliersOf(row.point_inliers, row.point_matches, row.localized, options);
    case ChangeKind::kLines:
      return InliersOf(row.usable_line_inliers + row.vertical_line_inliers,
                       row.usable_line_matches + row.vertical_line_matches, row.localized, options);
    case ChangeKind::kSuccess:
      return {Number(row.localized), Number(row.queries), IndependentQueries(row.queries, options)};
  }
  return {};
}

std::vector<ChangePoint> FindChanges(std::span<const SegmentSessionRow> rows,
                                     const StatisticsOptions& options) {
  std::vector<ChangePoint> changes;
  for (const ChangeKind kind : kChangeKinds) {
    if (const auto change = LastChange(kind, rows, options)) changes.push_back(*change);
  }
  return changes;
}

}  // namespace maploc
