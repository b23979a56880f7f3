// Segments that got worse: those whose share of localized queries, or whose inlier ratios, fell.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "mapstore/statistics/change.h"
#include "mapstore/store/map_store.h"

namespace maploc {

struct SegmentChanges {
  SegmentId segment = 0;
  std::vector<ChangePoint> changes;  // the last one of each kind
};

struct Decline {
  SegmentId segment = 0;
  ChangePoint change;
  // The share of what there was that is gone, in (0, 1].
  double Loss() const { return (change.before - change.after) / change.before; }
};

// Changes for the worse, the greatest loss first.
std::vector<Decline> RankDeclines(const std::vector<SegmentChanges>& segments);

// [{"kind", "since_session", "since_unix_ns", "since", "sessions", "before", "after", "deviation"}]
nlohmann::ordered_json ToJson(const std::vector<ChangePoint>& changes);

// The ranked list as a table, or that nothing fell.
void PrintDeclines(const std::vector<Decline>& declines);

}  // namespace maploc
