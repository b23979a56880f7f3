// What place recognition needs of segments, in SQLite. Derived from the segments' landmarks, and
// read without them. Callers hold the connection and a transaction.
#pragma once

#include <cstdint>
#include <vector>

#include "mapstore/descriptors/segment_place.h"
#include "mapstore/store/sqlite_maps.h"

namespace maploc {

// REQUIRES: the segment's row is there.
Status InsertPlace(SqliteDatabase& database, std::int64_t map, const SegmentPlace& place);
// Where there is no row it is derived from the segment. NOT_FOUND; DATA_LOSS (DAMAGED_SEGMENT).
Result<SegmentPlace> ReadPlace(SqliteDatabase& database, const StoredMap& map, SegmentId id);
// Of all segments, by id.
Result<std::vector<SegmentPlace>> ReadPlaces(SqliteDatabase& database, const StoredMap& map);
// For a migration: of every segment that has none, but those whose landmarks are damaged.
Status WriteMissingPlaces(SqliteDatabase& database);

}  // namespace maploc
