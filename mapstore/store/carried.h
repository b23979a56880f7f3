// What a version of a map inherits from older ones: which share of an older segment's rows counts
// in which segment of the new one. Pure functions that all stores share.
#pragma once

#include <compare>
#include <limits>
#include <span>
#include <vector>

#include "mapstore/model/map.h"
#include "mapstore/model/session.h"
#include "mapstore/statistics/carry_over.h"
#include "mapstore/statistics/selector.h"

namespace maploc {

// Of the rows of segment `from` of version `source` (a name for it: the store's own), the share
// `weight` counts in segment `to` of the version that inherits.
struct Inheritance {
  std::int64_t source = 0;
  SegmentId from = 0;
  SegmentId to = 0;
  double weight = 0.0;  // in (0, 1]
  bool operator==(const Inheritance&) const = default;
};

// A row's place in the folding order.
struct FoldPosition {
  std::int64_t session_start_unix_ns = 0;
  SessionId session;
  auto operator<=>(const FoldPosition&) const = default;
};

inline FoldPosition BeforeAllRows() { return {std::numeric_limits<std::int64_t>::min(), ""}; }
inline FoldPosition AfterAllRows() { return {std::numeric_limits<std::int64_t>::max(), ""}; }
inline FoldPosition PositionOf(const SegmentSessionRow& row) {
  return {row.session_start_unix_ns, row.session};
}

// A row with what the derivation needs to know of its session.
struct TrueRow {
  SegmentSessionRow row;
  std::int64_t source = 0;  // the version that the session was on
  std::int64_t end_unix_ns = 0;
  std::int64_t options = 0;  // a name of the options that its end was counted with: the store's own
  FoldPosition position() const { return PositionOf(row); }
};

// A segment's places alone: enough for finding landmarks again.
Segment WithoutDescriptors(const Segment& segment);

// What `fresh` inherits from the version before it (named `predecessor`), and through that version
// from older ones: `older` is what that version has itself inherited. Over its heirs, the weights
// of an older segment sum to the share of its landmarks that still exist. Ascending by (to, source,
// from).
std::vector<Inheritance> InheritFrom(std::int64_t predecessor, const MapInfo& old_info,
                                     std::span<const Segment> old_segments,
                                     std::span<const Inheritance> older, const MapInfo& fresh_info,
                                     std::span<const Segment> fresh_segments);

// The entries of `all` for the older segments that `segment` inherits from. Entries of other heirs
// are included, because a count is shared out among all heirs. The order is that of `all`.
std::vector<Inheritance> SharesBehind(SegmentId segment, std::span<const Inheritance> all);

// The rows of one segment, in folding order: its own, and what `inheritance` (SharesBehind it)
// makes of the `rows` of older versions (of the segments that this one inherits from), one for each
// of their sessions.
std::vector<TrueRow> WithInherited(SegmentId segment, std::vector<TrueRow> own,
                                   std::span<const TrueRow> rows,
                                   std::span<const Inheritance> inheritance);

}  // namespace maploc
