// A segment's statistics and strategy in SQLite: a history of decisions, of which the last is in
// force.
#pragma once

#include <optional>
#include <vector>

#include "mapstore/store/derivation.h"
#include "mapstore/store/map_store.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

// What is in force for a segment.
struct SegmentState {
  SegmentDerivation derived;
  std::optional<Strategy> pinned;
  SelectorOptions options;
};

// The state before the first decision is derived from no rows with `defaults`.
Result<SegmentState> ReadSegmentState(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                      const SelectorOptions& defaults);
Result<std::vector<DecisionRecord>> ReadDecisions(SqliteDatabase& database, std::int64_t map,
                                                  SegmentId id);
// REQUIRES: a write transaction.
Status InsertDecision(SqliteDatabase& database, std::int64_t map, SegmentId id,
                      std::int64_t time_unix_ns, const std::string& cause,
                      const SegmentState& state);

}  // namespace maploc
