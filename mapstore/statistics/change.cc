#include "mapstore/statistics/change.h"

#include <algorithm>
#include <cmath>

namespace maploc {
namespace {

constexpr double kZ99 = 2.5758293035489004;  // two-sided 99% of the normal distribution

}  // namespace

double DeviationOf(const Proportion& old, const Proportion& fresh) {
  const double old_count = std::min(old.total, old.independent);
  const double count = std::min(fresh.total, fresh.independent);
  if (old_count <= 0.0 || count <= 0.0) return 0.0;
  const double mean = (old.good / old.total * old_count + 0.5) / (old_count + 1.0);
  const double variance = mean * (1.0 - mean) * (1.0 / old_count + 1.0 / count);
  return (fresh.good / fresh.total - mean) / std::sqrt(variance);
}

bool IsChanged(const Proportion& old, const Proportion& fresh) {
  return std::abs(DeviationOf(old, fresh)) > kZ99;
}

}  // namespace maploc
