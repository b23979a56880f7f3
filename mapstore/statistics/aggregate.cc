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

StatisticsFold::StatisticsFold(const StatisticsOptions& options)
    : options_(options), decay_(std::exp2(-1.0 / options.half_life_sessions)) {}

bool StatisticsFold::IsChange(const SegmentSessionRow& row) const {
  return std::any_of(kChangeKinds.begin(), kChangeKinds.end(), [&](ChangeKind kind) {
    return IsChanged(shares_[IndexOf(kind)], ProportionOf(kind, row, options_));
  });
}

void StatisticsFold::Discount(double factor) {
  for (Proportion& share : shares_) Scale(factor, share);
  Scale(factor, usable_lines_);
  Scale(factor, vertical_lines_);
  for (double* medians : {&point_medians_, &usable_line_medians_, &vertical_line_medians_}) {
    *medians *= factor;
  }
}

void StatisticsFold::Add(const SegmentSessionRow& row) {
  Discount(decay_);
  if (IsChange(row)) Discount(options_.change_discount);
  ++sessions_;
  queries_ += row.queries;
  localized_ += row.localized;
  for (const ChangeKind kind : kChangeKinds) {
    AddTo(shares_[IndexOf(kind)], ProportionOf(kind, row, options_));
  }
  AddTo(usable_lines_,
        InliersOf(row.usable_line_inliers, row.usable_line_matches, row.localized, options_));
  AddTo(vertical_lines_,
        InliersOf(row.vertical_line_inliers, row.vertical_line_matches, row.localized, options_));
  point_medians_ += Number(row.localized) * row.median_point_matches;
  usable_line_medians_ += Number(row.localized) * row.median_usable_line_matches;
  vertical_line_medians_ += Number(row.localized) * row.median_vertical_line_matches;
}

SegmentStatistics StatisticsFold::Value() const {
  const Proportion& points = shares_[IndexOf(ChangeKind::kPoints)];
  const Proportion& success = shares_[IndexOf(ChangeKind::kSuccess)];
  SegmentStatistics value;
  value.sessions = sessions_;
  value.queries = queries_;
  value.localized = localized_;
  value.point_matches = points.total;
  value.point_inliers = points.good;
  value.usable_line_matches = usable_lines_.total;
  value.usable_line_inliers = usable_lines_.good;
  value.vertical_line_matches = vertical_lines_.total;
  value.vertical_line_inliers = vertical_lines_.good;
  value.weighted_queries = success.total;
  value.weighted_localized = success.good;
  value.independent_points = points.independent;
  value.independent_usable_lines = usable_lines_.independent;
  value.independent_vertical_lines = vertical_lines_.independent;
  if (success.good <= 0.0) return value;
  value.typical_point_matches = point_medians_ / success.good;
  value.typical_usable_line_matches = usable_line_medians_ / success.good;
  value.typical_vertical_line_matches = vertical_line_medians_ / success.good;
  return value;
}

SegmentStatistics Aggregate(std::span<const SegmentSessionRow> rows,
                            const StatisticsOptions& options) {
  StatisticsFold fold(options);
  for (const SegmentSessionRow& row : rows) fold.Add(row);
  return fold.Value();
}

}  // namespace maploc
