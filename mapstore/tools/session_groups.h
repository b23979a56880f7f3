// What the chosen sessions say about a map's segments: `maploc-map stats` without its printing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mapstore/statistics/change.h"
#include "mapstore/store/map_store.h"

namespace maploc {

struct GroupOptions {
  std::vector<std::string> labels;  // KEY=VALUE, all of which a session must have
  std::string by;                   // a label's key, or empty
  bool recompute = false;           // and compare with what is stored
};

// The sums over some of a map's sessions, with when they changed.
struct SegmentStats {
  SegmentSummary summary;
  std::vector<ChangePoint> changes;
  std::int64_t inherited_sessions = 0;  // of older versions
};

// The sessions that have one value of a label, or all of them.
struct SessionGroup {
  std::optional<std::string> value;  // nullopt: those without the label, or all
  std::vector<SegmentStats> segments;
};

// By the label's value; without `by` one group. All from one state of the store, which others may
// write to meanwhile: UNAVAILABLE (STORE_MOVES) when it never stood still. DATA_LOSS
// (DAMAGED_STORE) where `recompute` finds that a segment's statistics are not those of its rows.
Result<std::vector<SessionGroup>> ReadGroups(const MapStore& store, const MapKey& key,
                                             const GroupOptions& options);

}  // namespace maploc
