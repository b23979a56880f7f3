// Checkpoints of a segment's fold (FORMAT.md, `segment_folds`): with them a session's end adds its
// row to what the rows before it came to, instead of folding all rows ever. Derived data, so losing
// it costs time only. Callers hold the connection and the transaction.
#pragma once

#include <optional>
#include <vector>

#include "mapstore/statistics/selector.h"
#include "mapstore/store/carried.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

// The fold after the row at `position`.
struct FoldCheckpoint {
  FoldPosition position;
  SelectorState state;
  std::int64_t options = 0;      // that all rows so far were folded with
  std::int64_t row_options = 0;  // of the row at `position`
};

// One in `kRowsPerCheckpoint` rows has a checkpoint, and the last row: a session that ends after
// later ones did costs at most that many rows more. A state is 256 bytes: four a row.
inline constexpr std::int64_t kRowsPerCheckpoint = 64;
inline bool IsKept(const SelectorState& state) {
  return state.sums.sessions % kRowsPerCheckpoint == 0;
}

// The last one of a segment. One that is damaged counts as missing.
Result<std::optional<FoldCheckpoint>> ReadLastCheckpoint(SqliteDatabase& database, std::int64_t map,
                                                         SegmentId id);
// All of a segment, in folding order. DATA_LOSS (DAMAGED_STORE) if one is damaged.
Result<std::vector<FoldCheckpoint>> ReadCheckpoints(SqliteDatabase& database, std::int64_t map,
                                                    SegmentId id);

// REQUIRES: a write transaction (all below).
Status InsertCheckpoint(SqliteDatabase& database, std::int64_t map, SegmentId id,
                        const FoldCheckpoint& checkpoint);
Status DeleteCheckpoint(SqliteDatabase& database, std::int64_t map, SegmentId id,
                        const FoldPosition& position);
// Those at `from` and after it: rows there have changed.
Status DeleteCheckpointsFrom(SqliteDatabase& database, std::int64_t map, SegmentId id,
                             const FoldPosition& from);

}  // namespace maploc
