#include <algorithm>
#include <cmath>

#include "mapstore/statistics/statistics.h"

namespace maploc {
namespace {

double Number(std::int64_t count) { return static_cast<double>(count); }

std::size_t IndexOf(ChangeKind kind) { return static_cast<std::size_t>(kind) - 1; }

void Scale(double factor, Proportion& sum) {
  sum = {sum.good * factor, sum.total * factor, sum.independent * factor};
}

}  // namespace

StatisticsFold::StatisticsFold(const StatisticsOptions& options, const StatisticsSums& sums)
    : options_(options), decay_(std::exp2(-1.0 / options.half_life_sessions)), sums_(sums) {}

bool StatisticsFold::IsChange(const SegmentSessionRow& row) const {
  return std::any_of(kChangeKinds.begin(), kChangeKinds.end(), [&](ChangeKind kind) {
    return IsChanged(sums_.shares[IndexOf(kind)], ProportionOf(kind, row, options_),
                     sums_.scatters[IndexOf(kind)]);
  });
}

void StatisticsFold::AddScatter(const SegmentSessionRow& row) {
  for (const ChangeKind kind : kChangeKinds) {
    sums_.scatters[IndexOf(kind)].Add(sums_.shares[IndexOf(kind)],
                                      ProportionOf(kind, row, options_));
  }
}

void StatisticsFold::Age() {
  Discount(decay_);
  for (Scatter& scatter : sums_.scatters) scatter = {scatter.sum * decay_, scatter.weight * decay_};
}

void StatisticsFold::Discount(double factor) {
  for (SessionShares& sum : sums_.shares) {
    Scale(factor, sum.share);
    sum.sessions *= factor;
  }
  Scale(factor, sums_.usable_lines);
  Scale(factor, sums_.vertical_lines);
  for (double* medians :
       {&sums_.point_medians, &sums_.usable_line_medians, &sums_.vertical_line_medians}) {
    *medians *= factor;
  }
}

void StatisticsFold::Add(const SegmentSessionRow& row) {
  Age();
  // The row is judged by what is known without it. The scatter then learns from the same sums,
  // before a change discounts them.
  const bool is_change = IsChange(row);
  AddScatter(row);
  if (is_change) Discount(options_.change_discount);
  ++sums_.sessions;
  sums_.queries += row.queries;
  sums_.localized += row.localized;
  for (const ChangeKind kind : kChangeKinds) {
    AddTo(sums_.shares[IndexOf(kind)], ProportionOf(kind, row, options_));
  }
  AddTo(sums_.usable_lines,
        InliersOf(row.usable_line_inliers, row.usable_line_matches, row.localized, options_));
  AddTo(sums_.vertical_lines,
        InliersOf(row.vertical_line_inliers, row.vertical_line_matches, row.localized, options_));
  sums_.point_medians += Number(row.localized) * row.median_point_matches;
  sums_.usable_line_medians += Number(row.localized) * row.median_usable_line_matches;
  sums_.vertical_line_medians += Number(row.localized) * row.median_vertical_line_matches;
}

SegmentStatistics StatisticsFold::Value() const {
  const Proportion& points = sums_.shares[IndexOf(ChangeKind::kPoints)].share;
  const Proportion& success = sums_.shares[IndexOf(ChangeKind::kSuccess)].share;
  SegmentStatistics value;
  value.sessions = sums_.sessions;
  value.queries = sums_.queries;
  value.localized = sums_.localized;
  value.point_matches = points.total;
  value.point_inliers = points.good;
  value.usable_line_matches = sums_.usable_lines.total;
  value.usable_line_inliers = sums_.usable_lines.good;
  value.vertical_line_matches = sums_.vertical_lines.total;
  value.vertical_line_inliers = sums_.vertical_lines.good;
  value.weighted_queries = success.total;
  value.weighted_localized = success.good;
  value.independent_points = points.independent;
  value.independent_usable_lines = sums_.usable_lines.independent;
  value.independent_vertical_lines = sums_.vertical_lines.independent;
  if (success.good <= 0.0) return value;
  value.typical_point_matches = sums_.point_medians / success.good;
  value.typical_usable_line_matches = sums_.usable_line_medians / success.good;
  value.typical_vertical_line_matches = sums_.vertical_line_medians / success.good;
  return value;
}

SegmentStatistics Aggregate(std::span<const SegmentSessionRow> rows,
                            const StatisticsOptions& options) {
  StatisticsFold fold(options);
  for (const SegmentSessionRow& row : rows) fold.Add(row);
  return fold.Value();
}

}  // namespace maploc
