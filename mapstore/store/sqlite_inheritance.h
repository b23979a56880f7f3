// What versions of a map inherit from older ones, in SQLite. Callers hold the connection and the
// transaction.
#pragma once

#include <utility>
#include <vector>

#include "mapstore/store/carried.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

// Of a whole version, ascending by (to, source, from); `source` is a map's row.
Result<std::vector<Inheritance>> ReadInheritance(SqliteDatabase& database, std::int64_t map);
// REQUIRES: a write transaction.
Status InsertInheritance(SqliteDatabase& database, std::int64_t map, const Inheritance& share);

// The segments of newer versions (map's row, segment) that inherit from this one.
Result<std::vector<std::pair<std::int64_t, SegmentId>>> ReadHeirs(SqliteDatabase& database,
                                                                  std::int64_t map, SegmentId id);

// The rows of unrevoked sessions that count in a segment, its own and inherited ones, in folding
// order; those after `after`.
Result<std::vector<TrueRow>> ReadTrueRows(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                          const FoldPosition& after);

}  // namespace maploc
