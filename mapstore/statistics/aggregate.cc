#include <algorithm>
#include <cmath>

#include "mapstore/statistics/statistics.h"

namespace maploc {
namespace {

constexpr double kZ99 = 2.5758293035489004;  // two-sided 99% of the normal distribution

// Does the ratio of a session lie outside the interval that older ones predict for it? The sum of
// `matches` is worth no more than `most` independent ones. The mean is Jeffreys' (half an inlier
// and half an outlier added), so that a spotless record does not predict perfection.
bool IsOutside(double old_inliers, double old_matches, double old_most, double inliers,
               double matches, double most) {
  const double old_count = std::min(old_matches, old_most);
  const double count = std::min(matches, most);
  if (old_count <= 0.0 || count <= 0.0) return false;
  const double mean = (old_inliers / old_matches * old_count + 0.5) / (old_count + 1.0);
  const double variance = mean * (1.0 - mean) * (1.0 / old_count + 1.0 / count);
  return std::abs(inliers / matches - mean) > kZ99 * std::sqrt(variance);
}

}  // namespace

StatisticsFold::StatisticsFold(const StatisticsOptions& options)
    : options_(options), decay_(std::exp2(-1.0 / options.half_life_sessions)) {}

bool StatisticsFold::IsChange(const SegmentSessionRow& row) const {
  const double old_most = localized_ * options_.independent_matches_per_query;
  const double most = static_cast<double>(row.localized) * options_.independent_matches_per_query;
  return IsOutside(sum_.point_inliers, sum_.point_matches, old_most,
                   static_cast<double>(row.point_inliers), static_cast<double>(row.point_matches),
                   most) ||
         IsOutside(sum_.usable_line_inliers + sum_.vertical_line_inliers,
                   sum_.usable_line_matches + sum_.vertical_line_matches, old_most,
                   static_cast<double>(row.usable_line_inliers + row.vertical_line_inliers),
                   static_cast<double>(row.usable_line_matches + row.vertical_line_matches), most);
}

void StatisticsFold::Discount(double factor) {
  for (double* value :
       {&sum_.point_matches, &sum_.point_inliers, &sum_.usable_line_matches,
        &sum_.usable_line_inliers, &sum_.vertical_line_matches, &sum_.vertical_line_inliers,
        &localized_, &point_medians_, &usable_line_medians_, &vertical_line_medians_}) {
    *value *= factor;
  }
}

void StatisticsFold::Add(const SegmentSessionRow& row) {
  Discount(decay_);
  if (IsChange(row)) Discount(options_.change_discount);
  const double localized = static_cast<double>(row.localized);
  ++sum_.sessions;
  sum_.queries += row.queries;
  sum_.localized += row.localized;
  sum_.point_matches += static_cast<double>(row.point_matches);
  sum_.point_inliers += static_cast<double>(row.point_inliers);
  sum_.usable_line_matches += static_cast<double>(row.usable_line_matches);
  sum_.usable_line_inliers += static_cast<double>(row.usable_line_inliers);
  sum_.vertical_line_matches += static_cast<double>(row.vertical_line_matches);
  sum_.vertical_line_inliers += static_cast<double>(row.vertical_line_inliers);
  localized_ += localized;
  point_medians_ += localized * row.median_point_matches;
  usable_line_medians_ += localized * row.median_usable_line_matches;
  vertical_line_medians_ += localized * row.median_vertical_line_matches;
}

SegmentStatistics StatisticsFold::Value() const {
  SegmentStatistics value = sum_;
  if (localized_ <= 0.0) return value;
  value.typical_point_matches = point_medians_ / localized_;
  value.typical_usable_line_matches = usable_line_medians_ / localized_;
  value.typical_vertical_line_matches = vertical_line_medians_ / localized_;
  return value;
}

SegmentStatistics Aggregate(std::span<const SegmentSessionRow> rows,
                            const StatisticsOptions& options) {
  StatisticsFold fold(options);
  for (const SegmentSessionRow& row : rows) fold.Add(row);
  return fold.Value();
}

}  // namespace maploc
