#include <algorithm>
#include <cmath>

#include "mapstore/statistics/statistics.h"

namespace maploc {
namespace {

double Number(std::int64_t count) { return static_cast<double>(count); }

std::size_t IndexOf(ChangeKind kind) { return static_cast<std::size_t>(kind) - 1; }

}  // namespace

StatisticsFold::StatisticsFold(const StatisticsOptions& options)
    : options_(options), decay_(std::exp2(-1.0 / options.half_life_sessions)) {}

bool StatisticsFold::IsChange(const SegmentSessionRow& row) const {
  return std::any_of(kChangeKinds.begin(), kChangeKinds.end(), [&](ChangeKind kind) {
    return IsChanged(shares_[IndexOf(kind)], ProportionOf(kind, row, options_));
  });
}

void StatisticsFold::Discount(double factor) {
  for (double* value :
       {&sum_.point_matches, &sum_.point_inliers, &sum_.usable_line_matches,
        &sum_.usable_line_inliers, &sum_.vertical_line_matches, &sum_.vertical_line_inliers,
        &sum_.weighted_queries, &sum_.weighted_localized, &sum_.independent_points,
        &sum_.independent_usable_lines, &sum_.independent_vertical_lines, &point_medians_,
        &usable_line_medians_, &vertical_line_medians_}) {
    *value *= factor;
  }
  for (Proportion& share : shares_) {
    share = {share.good * factor, share.total * factor, share.independent * factor};
  }
}

void StatisticsFold::Add(const SegmentSessionRow& row) {
  Discount(decay_);
  if (IsChange(row)) Discount(options_.change_discount);
  ++sum_.sessions;
  sum_.queries += row.queries;
  sum_.localized += row.localized;
  sum_.point_matches += Number(row.point_matches);
  sum_.point_inliers += Number(row.point_inliers);
  sum_.usable_line_matches += Number(row.usable_line_matches);
  sum_.usable_line_inliers += Number(row.usable_line_inliers);
  sum_.vertical_line_matches += Number(row.vertical_line_matches);
  sum_.vertical_line_inliers += Number(row.vertical_line_inliers);
  sum_.weighted_queries += Number(row.queries);
  sum_.weighted_localized += Number(row.localized);
  const auto independent = [&](std::int64_t matches) {
    return IndependentMatches(row.localized, matches, options_);
  };
  sum_.independent_points += independent(row.point_matches);
  sum_.independent_usable_lines += independent(row.usable_line_matches);
  sum_.independent_vertical_lines += independent(row.vertical_line_matches);
  for (const ChangeKind kind : kChangeKinds) {
    AddTo(shares_[IndexOf(kind)], ProportionOf(kind, row, options_));
  }
  point_medians_ += Number(row.localized) * row.median_point_matches;
  usable_line_medians_ += Number(row.localized) * row.median_usable_line_matches;
  vertical_line_medians_ += Number(row.localized) * row.median_vertical_line_matches;
}

SegmentStatistics StatisticsFold::Value() const {
  SegmentStatistics value = sum_;
  if (sum_.weighted_localized <= 0.0) return value;
  value.typical_point_matches = point_medians_ / sum_.weighted_localized;
  value.typical_usable_line_matches = usable_line_medians_ / sum_.weighted_localized;
  value.typical_vertical_line_matches = vertical_line_medians_ / sum_.weighted_localized;
  return value;
}

SegmentStatistics Aggregate(std::span<const SegmentSessionRow> rows,
                            const StatisticsOptions& options) {
  StatisticsFold fold(options);
  for (const SegmentSessionRow& row : rows) fold.Add(row);
  return fold.Value();
}

}  // namespace maploc
