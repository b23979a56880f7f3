#include "mapstore/statistics/change.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace maploc {
namespace {

constexpr double kZ999 = 3.2905267314918946;  // two-sided 99.9% of the normal distribution
constexpr double kMinSplitDeviation = 4.3;
constexpr double kUsualScatter = 0.02;  // a standard deviation of .07 about a half
constexpr double kUsualScatterWeight = 4.0;

double Number(std::int64_t count) { return static_cast<double>(count); }

double Trials(const Proportion& share) { return std::min(share.total, share.independent); }

// A difference of two shares with mean m, and its variance by cause, divided by m (1 - m).
struct Difference {
  double difference = 0.0;
  double unit = 0.0;      // m (1 - m)
  double counting = 0.0;  // the variance of both counts
  double sessions = 0.0;  // what a scatter of 1 would add

  double Squared() const { return difference * difference / unit; }
  double Variance(double scatter) const { return counting + scatter * sessions; }
};

std::optional<Difference> Compare(const SessionShares& before, const SessionShares& after) {
  const double n = Trials(before.share);
  const double m = Trials(after.share);
  if (n <= 0.0 || m <= 0.0) return std::nullopt;
  const double low = before.share.good / before.share.total;
  const double high = after.share.good / after.share.total;
  // Jeffreys' mean: half a good and half a bad trial are added, so that a record without a failure
  // does not predict perfection.
  const double mean = (low * n + high * m + 0.5) / (n + m + 1.0);
  return Difference{high - low, mean * (1.0 - mean), 1.0 / n + 1.0 / m,
                    1.0 / before.sessions + 1.0 / after.sessions};
}

// Sums of the first n sessions' shares, n from 0.
std::vector<SessionShares> PrefixSums(ChangeKind kind, std::span<const SegmentSessionRow> rows,
                                      const StatisticsOptions& options) {
  std::vector<SessionShares> sums(1);
  for (const SegmentSessionRow& row : rows) {
    sums.push_back(sums.back());
    AddTo(sums.back(), ProportionOf(kind, row, options));
  }
  return sums;
}

SessionShares Between(const std::vector<SessionShares>& sums, std::size_t begin, std::size_t end) {
  const Proportion& last = sums[end].share;
  const Proportion& first = sums[begin].share;
  return {{last.good - first.good, last.total - first.total, last.independent - first.independent},
          sums[end].sessions - sums[begin].sessions};
}

// Of each session beside the one before it: across a change only two neighbours differ.
Scatter ScatterOfNeighbours(ChangeKind kind, std::span<const SegmentSessionRow> rows,
                            const StatisticsOptions& options) {
  Scatter scatter;
  SessionShares previous;
  for (const SegmentSessionRow& row : rows) {
    const Proportion share = ProportionOf(kind, row, options);
    if (Trials(share) <= 0.0) continue;
    scatter.Add(previous, share);
    previous = {share, 1.0};
  }
  return scatter;
}

struct Split {
  std::size_t at = 0;
  double deviation = 0.0;
};

Split BestSplit(const std::vector<SessionShares>& sums, std::size_t begin, std::size_t end,
                double scatter) {
  Split best;
  for (std::size_t at = begin + 1; at < end; ++at) {
    const double deviation = Deviation(Between(sums, begin, at), Between(sums, at, end), scatter);
    if (std::abs(deviation) > std::abs(best.deviation)) best = {at, deviation};
  }
  return best;
}

std::optional<ChangePoint> LastChange(ChangeKind kind, std::span<const SegmentSessionRow> rows,
                                      const StatisticsOptions& options) {
  const std::vector<SessionShares> sums = PrefixSums(kind, rows, options);
  const double scatter = ScatterOfNeighbours(kind, rows, options).Value();
  std::optional<ChangePoint> change;
  std::size_t begin = 0;
  while (true) {
    const Split split = BestSplit(sums, begin, rows.size(), scatter);
    if (std::abs(split.deviation) < kMinSplitDeviation) return change;
    const Proportion before = Between(sums, begin, split.at).share;
    const Proportion after = Between(sums, split.at, rows.size()).share;
    change = {kind,
              rows[split.at].session,
              rows[split.at].session_start_unix_ns,
              static_cast<std::int64_t>(rows.size() - split.at),
              before.good / before.total,
              after.good / after.total,
              split.deviation};
    // The later side may have changed once more, and the last change counts.
    begin = split.at;
  }
}

}  // namespace

double Scatter::Value() const {
  return std::clamp((sum + kUsualScatterWeight * kUsualScatter) / (weight + kUsualScatterWeight),
                    0.0, 1.0);
}

void Scatter::Add(const SessionShares& old, const Proportion& fresh) {
  const auto difference = Compare(old, {fresh, 1.0});
  if (!difference) return;
  const double tolerated = kZ999 * kZ999 * difference->Variance(Value());
  const double squared = std::min(difference->Squared(), tolerated);
  // How much of a usual squared difference is scatter; the variance of the rest is its square.
  const double part = kUsualScatter * difference->sessions / difference->Variance(kUsualScatter);
  sum += part * part * (squared - difference->counting) / difference->sessions;
  weight += part * part;
}

double Deviation(const SessionShares& before, const SessionShares& after, double scatter) {
  const auto difference = Compare(before, after);
  if (!difference) return 0.0;
  return difference->difference / std::sqrt(difference->unit * difference->Variance(scatter));
}

bool IsChanged(const SessionShares& old, const Proportion& fresh, const Scatter& scatter) {
  return std::abs(Deviation(old, {fresh, 1.0}, scatter.Value())) > kZ999;
}

void AddTo(Proportion& sum, const Proportion& share) {
  sum.good += share.good;
  sum.total += share.total;
  sum.independent += Trials(share);
}

void AddTo(SessionShares& sum, const Proportion& share) {
  AddTo(sum.share, share);
  sum.sessions += Trials(share) > 0.0 ? 1.0 : 0.0;
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
