#include <algorithm>
#include <cmath>

#include "mapstore/statistics/change.h"
#include "mapstore/statistics/statistics.h"

namespace maploc {
namespace {

double Number(std::int64_t count) { return static_cast<double>(count); }

}  // namespace

StatisticsFold::StatisticsFold(const StatisticsOptions& options)
    : options_(options), decay_(std::exp2(-1.0 / options.half_life_sessions)) {}

double StatisticsFold::IndependentQueries(std::int64_t queries) const {
  return std::min(static_cast<double>(queries), options_.independent_queries_per_session);
}

double StatisticsFold::IndependentMatches(const SegmentSessionRow& row,
                                          std::int64_t matches) const {
  return std::min(static_cast<double>(matches),
                  IndependentQueries(row.localized) * options_.independent_matches_per_query);
}

bool StatisticsFold::IsChange(const SegmentSessionRow& row) const {
  const std::int64_t lines = row.usable_line_matches + row.vertical_line_matches;
  const Proportion points = {Number(row.point_inliers), Number(row.point_matches),
                             IndependentMatches(row, row.point_matches)};
  const Proportion both_lines = {Number(row.usable_line_inliers + row.vertical_line_inliers),
                                 Number(lines), IndependentMatches(row, lines)};
  const Proportion success = {Number(row.localized), Number(row.queries),
                              IndependentQueries(row.queries)};
  return IsChanged({sum_.point_inliers, sum_.point_matches, sum_.independent_points}, points) ||
         IsChanged({sum_.usable_line_inliers + sum_.vertical_line_inliers,
                    sum_.usable_line_matches + sum_.vertical_line_matches, independent_lines_},
                   both_lines) ||
         IsChanged({sum_.weighted_localized, sum_.weighted_queries, independent_queries_}, success);
}

void StatisticsFold::Discount(double factor) {
  for (double* value :
       {&sum_.point_matches, &sum_.point_inliers, &sum_.usable_line_matches,
        &sum_.usable_line_inliers, &sum_.vertical_line_matches, &sum_.vertical_line_inliers,
        &sum_.weighted_queries, &sum_.weighted_localized, &sum_.independent_points,
        &sum_.independent_usable_lines, &sum_.independent_vertical_lines, &independent_lines_,
        &independent_queries_, &point_medians_, &usable_line_medians_, &vertical_line_medians_}) {
    *value *= factor;
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
  AddIndependent(row);
  point_medians_ += Number(row.localized) * row.median_point_matches;
  usable_line_medians_ += Number(row.localized) * row.median_usable_line_matches;
  vertical_line_medians_ += Number(row.localized) * row.median_vertical_line_matches;
}

void StatisticsFold::AddIndependent(const SegmentSessionRow& row) {
  sum_.independent_points += IndependentMatches(row, row.point_matches);
  sum_.independent_usable_lines += IndependentMatches(row, row.usable_line_matches);
  sum_.independent_vertical_lines += IndependentMatches(row, row.vertical_line_matches);
  independent_lines_ +=
      IndependentMatches(row, row.usable_line_matches + row.vertical_line_matches);
  independent_queries_ += IndependentQueries(row.queries);
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
