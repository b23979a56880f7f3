// Reading maps and segments out of SQLite. Callers hold the connection; where several calls must
// agree, they hold a transaction too. DATA_LOSS where bytes do not fit.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapstore/store/map_store.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

// A published version and its row.
struct StoredMap {
  std::int64_t row_id = 0;
  MapSummary summary;

  const MapKey& key() const { return summary.info.key; }
};

Result<std::vector<StoredMap>> ReadAllMaps(SqliteDatabase& database);  // by name, then version
Result<StoredMap> ReadEnabledMap(SqliteDatabase& database, const std::string& name);
Result<StoredMap> ReadMap(SqliteDatabase& database, const MapKey& key);
// Also one that was deleted: its sessions are still there.
Result<StoredMap> ReadMapOfSession(SqliteDatabase& database, const Session& session);

// Without the statistics (sqlite_states.h). NOT_FOUND.
Result<SegmentSummary> ReadSegmentCounts(SqliteDatabase& database, const StoredMap& map,
                                         SegmentId id);
// NOT_FOUND unless the segment is there.
Status RequireSegment(SqliteDatabase& database, const StoredMap& map, SegmentId id);
// For messages: file, map, version and segment.
std::string WhereIs(const SqliteDatabase& database, const StoredMap& map, SegmentId id);
// The landmarks, every invariant checked.
Result<std::shared_ptr<const Segment>> ReadSegment(SqliteDatabase& database, const StoredMap& map,
                                                   SegmentId id);

}  // namespace maploc
