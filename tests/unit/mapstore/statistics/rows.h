// Rows of sessions, for tests of what is made of them.
#pragma once

#include <cmath>
#include <string>

#include "mapstore/model/session.h"

namespace maploc::testing {

// `localized` queries, none failed, of so many matches each and at these inlier rates. The session
// "s<start>" began at `start`.
inline SegmentSessionRow Row(int start, int localized, int points, double point_rate,
                             int usable_lines = 0, double line_rate = 0.0) {
  SegmentSessionRow row;
  row.session = "s" + std::to_string(start);
  row.session_start_unix_ns = start;
  row.queries = localized;
  row.localized = localized;
  row.point_matches = localized * points;
  row.point_inliers = std::lround(localized * points * point_rate);
  row.usable_line_matches = localized * usable_lines;
  row.usable_line_inliers = std::lround(localized * usable_lines * line_rate);
  row.median_point_matches = points;
  row.median_usable_line_matches = usable_lines;
  return row;
}

}  // namespace maploc::testing
