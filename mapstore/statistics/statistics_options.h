// How rows become statistics. A part of SelectorOptions, stored with them.
#pragma once

#include <algorithm>
#include <cstdint>

namespace maploc {

struct StatisticsOptions {
  double half_life_sessions = 20.0;  // a session this much older counts half; positive
  // A session whose own inlier ratio (of points, or of lines), or whose own share of localized
  // queries, lies outside the 99% interval that the older sessions predict for it tells of a
  // change: the older ones keep this share of their weight. In [0, 1]; 1 turns it off.
  double change_discount = 0.02;
  // How many independent matches a localized query is worth, at most, and how many independent
  // queries a session. The matches of one view stand and fall together, and so do the views of one
  // session (one light, one season); taken as independent, they would make every session a change
  // and every ratio certain. Positive.
  double independent_matches_per_query = 10.0;
  double independent_queries_per_session = 20.0;
  bool operator==(const StatisticsOptions&) const = default;
};

inline double IndependentQueries(std::int64_t queries, const StatisticsOptions& options) {
  return std::min(static_cast<double>(queries), options.independent_queries_per_session);
}

}  // namespace maploc
