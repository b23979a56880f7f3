// How rows become statistics. A part of SelectorOptions, stored with them.
#pragma once

#include <algorithm>
#include <cstdint>

namespace maploc {

struct StatisticsOptions {
  double half_life_sessions = 20.0;  // a session this much older counts half; positive
  // A session signals a change if its own inlier ratio (of points, or of lines), or its own share
  // of localized queries, lies outside the 99.9% interval that the older sessions predict for it.
  // The older sessions then keep this share of their weight. In [0, 1]; 1 turns it off.
  double change_discount = 0.002;
  // How many independent matches a localized query is worth, at most, and how many independent
  // queries a session. The matches of one view are correlated, and so are the views of one session
  // (one light, one season). If they counted as independent, every session would look like a change
  // and every ratio would look certain. Positive.
  double independent_matches_per_query = 10.0;
  double independent_queries_per_session = 20.0;
  bool operator==(const StatisticsOptions&) const = default;
};

inline double IndependentQueries(std::int64_t queries, const StatisticsOptions& options) {
  return std::min(static_cast<double>(queries), options.independent_queries_per_session);
}

}  // namespace maploc
