// What is true of a segment in SQLite (rows, pins), and what is derived from it and kept beside it:
// statistics and strategy in force. Callers hold the connection and the transaction.
#pragma once

#include "mapstore/store/carried.h"
#include "mapstore/store/derivation.h"
#include "mapstore/store/map_store.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

// `defaults` are the options of a segment that has neither rows nor pins.
Result<SegmentTruth> ReadTruth(SqliteDatabase& database, std::int64_t map, SegmentId id,
                               const SelectorOptions& defaults);
// What is kept; before the first row or pin it is derived from nothing with `defaults`.
Result<SegmentState> ReadSegmentState(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                      const SelectorOptions& defaults);

// The segments whose state has changed since the change counter was `since`, ascending; all where a
// state has been deleted since.
Result<std::vector<SegmentId>> ReadChanged(SqliteDatabase& database, std::int64_t map,
                                           std::int64_t since);

// The row of these options, made where there is none yet. REQUIRES: a write transaction (all
// below).
Result<std::int64_t> OptionsRow(SqliteDatabase& database, const SelectorOptions& options);
Status InsertPin(SqliteDatabase& database, std::int64_t map, SegmentId id, const Pin& pin,
                 const SelectorOptions& options);
// Brings what is kept of a segment up to its truth, and tells it. Rows before `changed` are as they
// were; so the fold goes on from the last checkpoint before it (sqlite_folds.h).
Result<SegmentState> DeriveAnew(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                const SelectorOptions& defaults, const FoldPosition& changed);
// The same for every segment; afterwards what is kept is this program's derivation.
Status DeriveAllAnew(SqliteDatabase& database);

// Whether another program (another selector, another compiler) derived what is kept.
Result<bool> IsStale(SqliteDatabase& database);

}  // namespace maploc
