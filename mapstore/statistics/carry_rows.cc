#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "mapstore/statistics/carry_over.h"

namespace maploc {
namespace {

// Less is not lost but the rounding of weights.
constexpr double kNothingLost = 1e-9;

// Parts of `count` in proportion to `weights` that add up to it, by the largest remainder; between
// equal ones the first.
std::vector<std::int64_t> Apportion(std::int64_t count, const std::vector<double>& weights) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::int64_t left = count;
  std::vector<std::int64_t> parts;
  std::vector<double> remainders;
  for (const double weight : weights) {
    const double quota = static_cast<double>(count) * weight / total;
    // A rounding error can make the quotas' sum larger than the count.
    const bool rest = quota >= static_cast<double>(left);
    parts.push_back(rest ? left : static_cast<std::int64_t>(std::floor(quota)));
    remainders.push_back(quota - static_cast<double>(parts.back()));
    left -= parts.back();
  }
  std::vector<std::size_t> order(weights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return remainders[a] > remainders[b]; });
  for (std::size_t i = 0; left > 0; i = (i + 1) % order.size(), --left) ++parts[order[i]];
  return parts;
}

struct Counted {
  std::vector<std::int64_t> all;
  std::vector<std::int64_t> good;
};

// What is good and what is not are shared out each by itself: so no part has more good ones than
// there are.
Counted ApportionBoth(std::int64_t all, std::int64_t good, const std::vector<double>& weights) {
  Counted parts{Apportion(all - good, weights), Apportion(good, weights)};
  for (std::size_t i = 0; i < weights.size(); ++i) parts.all[i] += parts.good[i];
  return parts;
}

// Matches go where the localized queries went that saw them.
std::vector<double> WeightsOfMatches(const std::vector<std::int64_t>& localized,
                                     const std::vector<double>& weights) {
  if (std::all_of(localized.begin(), localized.end(), [](std::int64_t n) { return n <= 0; })) {
    return weights;
  }
  return {localized.begin(), localized.end()};
}

// One part for each heir; what nobody inherits is left out.
std::vector<SegmentSessionRow> Split(const SegmentSessionRow& row,
                                     std::span<const CarriedShare> heirs) {
  std::vector<double> weights;
  for (const CarriedShare& heir : heirs) weights.push_back(heir.weight);
  const double lost = 1.0 - std::accumulate(weights.begin(), weights.end(), 0.0);
  if (lost > kNothingLost) weights.push_back(lost);
  const Counted queries = ApportionBoth(row.queries, row.localized, weights);
  const std::vector<double> by_query = WeightsOfMatches(queries.good, weights);
  const Counted points = ApportionBoth(row.point_matches, row.point_inliers, by_query);
  const Counted lines = ApportionBoth(row.usable_line_matches, row.usable_line_inliers, by_query);
  const Counted verticals =
      ApportionBoth(row.vertical_line_matches, row.vertical_line_inliers, by_query);
  std::vector<SegmentSessionRow> parts(heirs.size(), row);
  for (std::size_t i = 0; i < heirs.size(); ++i) {
    SegmentSessionRow& part = parts[i];
    part.segment = heirs[i].to;
    part.queries = queries.all[i];
    part.localized = queries.good[i];
    part.point_matches = points.all[i];
    part.point_inliers = points.good[i];
    part.usable_line_matches = lines.all[i];
    part.usable_line_inliers = lines.good[i];
    part.vertical_line_matches = verticals.all[i];
    part.vertical_line_inliers = verticals.good[i];
  }
  return parts;
}

// Mean weighted by localized queries; of one part, or of equal ones, the very bits.
double MeanMedian(std::span<const SegmentSessionRow> parts, double SegmentSessionRow::*median) {
  double first = 0.0;
  double differences = 0.0;
  double localized = 0.0;
  for (const SegmentSessionRow& part : parts) {
    if (part.localized <= 0) continue;
    if (localized == 0.0) first = part.*median;
    localized += static_cast<double>(part.localized);
    differences += static_cast<double>(part.localized) * (part.*median - first);
  }
  return localized > 0.0 ? first + differences / localized : 0.0;
}

SegmentSessionRow Merge(std::span<const SegmentSessionRow> parts) {
  SegmentSessionRow row = parts.front();
  for (const SegmentSessionRow& part : parts.subspan(1)) {
    row.queries += part.queries;
    row.localized += part.localized;
    row.point_matches += part.point_matches;
    row.point_inliers += part.point_inliers;
    row.usable_line_matches += part.usable_line_matches;
    row.usable_line_inliers += part.usable_line_inliers;
    row.vertical_line_matches += part.vertical_line_matches;
    row.vertical_line_inliers += part.vertical_line_inliers;
  }
  row.median_point_matches = MeanMedian(parts, &SegmentSessionRow::median_point_matches);
  row.median_usable_line_matches =
      MeanMedian(parts, &SegmentSessionRow::median_usable_line_matches);
  row.median_vertical_line_matches =
      MeanMedian(parts, &SegmentSessionRow::median_vertical_line_matches);
  return row;
}

}  // namespace

std::vector<SegmentSessionRow> CarryRows(std::span<const SegmentSessionRow> rows,
                                         std::span<const CarriedShare> shares) {
  std::map<SegmentId, std::vector<SegmentSessionRow>> heirs;
  for (const SegmentSessionRow& row : rows) {
    std::vector<CarriedShare> of_row;
    std::copy_if(shares.begin(), shares.end(), std::back_inserter(of_row),
                 [&](const CarriedShare& share) { return share.from == row.segment; });
    for (SegmentSessionRow& part : Split(row, of_row)) {
      heirs[part.segment].push_back(std::move(part));
    }
  }
  std::vector<SegmentSessionRow> carried;
  for (const auto& [segment, parts] : heirs) {
    SegmentSessionRow row = Merge(parts);
    if (row.queries > 0) carried.push_back(std::move(row));
  }
  return carried;
}

}  // namespace maploc
