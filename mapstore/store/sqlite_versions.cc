#include "mapstore/store/sqlite_versions.h"

#include <optional>

#include "mapstore/store/sqlite_maps.h"
#include "mapstore/store/sqlite_space.h"
#include "mapstore/store/validation.h"

namespace maploc {
namespace {

Status RefuseUsed(SqliteDatabase& database, const StoredMap& map) {
  if (map.summary.enabled) return VersionEnabled(map.key());
  SqliteStatement open(database,
                       "SELECT COUNT(*) AS count FROM sessions WHERE map = ?1 AND end = 0");
  MAPLOC_ASSIGN_OR_RETURN(const bool row, open.Bind(map.row_id).Step());
  const std::int64_t sessions = row ? open.Int("count") : 0;
  return sessions == 0 ? Status::Ok() : VersionInUse(map.key(), sessions);
}

// From here on nobody finds the version; its landmarks are deleted after that.
Result<std::int64_t> MarkDeleted(SqliteConnections& connections, const MapKey& key) {
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(writer.database(), key));
  MAPLOC_RETURN_IF_ERROR(RefuseUsed(writer.database(), map));
  SqliteStatement mark(writer.database(),
                       "UPDATE map_versions SET deleted = 1, enabled_order = 0 WHERE id = ?1");
  MAPLOC_RETURN_IF_ERROR(mark.Bind(map.row_id).Run());
  MAPLOC_RETURN_IF_ERROR(writer.CommitVisibly());
  return map.row_id;
}

// A segment a transaction, so that nobody waits long for the write lock. False: none is left.
Result<bool> DeleteOneSegment(SqliteConnections& connections) {
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
  SqliteDatabase& database = writer.database();
  SqliteStatement find(database,
                       "SELECT f.map, f.segment FROM segment_features f JOIN map_versions m "
                       "ON m.id = f.map WHERE m.deleted = 1 LIMIT 1");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, find.Step());
  if (!found) return false;
  const std::int64_t map = find.Int("map");
  const std::int64_t segment = find.Int("segment");
  // The row of `segments` stays, because rows of statistics refer to it and newer versions inherit
  // them.
  for (const char* sql :
       {"DELETE FROM segment_features WHERE map = ?1 AND segment = ?2",
        "DELETE FROM segment_places WHERE map = ?1 AND segment = ?2",
        "DELETE FROM segment_folds WHERE map = ?1 AND segment = ?2",
        "DELETE FROM segment_states WHERE map = ?1 AND segment = ?2",
        "UPDATE segments SET path_count = 0, path = x'' WHERE map = ?1 AND segment = ?2"}) {
    SqliteStatement remove(database, sql);
    MAPLOC_RETURN_IF_ERROR(remove.Bind(map, segment).Run());
  }
  MAPLOC_RETURN_IF_ERROR(writer.Commit());
  return true;
}

}  // namespace

Status EnableRow(SqliteDatabase& database, std::int64_t map) {
  SqliteStatement enable(database,
                         "UPDATE map_versions SET enabled_order = 1 + (SELECT MAX(enabled_order) "
                         "FROM map_versions others WHERE others.name = map_versions.name) "
                         "WHERE id = ?1");
  return enable.Bind(map).Run();
}

Status MarkOlderDeleted(SqliteDatabase& database, const std::string& name, KeptVersions keep) {
  if (!keep) return Status::Ok();
  const Result<StoredMap> enabled = ReadEnabledMap(database, name);
  if (enabled.status().code() == StatusCode::kNotFound) return Status::Ok();
  if (!enabled.ok()) return enabled.status();
  SqliteStatement mark(database,
                       "UPDATE map_versions SET deleted = 1, enabled_order = 0 WHERE id IN ("
                       "SELECT id FROM map_versions WHERE name = ?1 AND state = 1 AND deleted = 0 "
                       "AND version < ?2 ORDER BY enabled_order DESC, version DESC "
                       "LIMIT -1 OFFSET ?3) AND NOT EXISTS ("
                       "SELECT 1 FROM sessions s WHERE s.map = map_versions.id AND s.end = 0)");
  return mark.Bind(name, enabled->key().version, *keep).Run();
}

Status EnableSqliteVersion(SqliteConnections& connections, const MapKey& key, KeptVersions keep) {
  {
    MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
    SqliteDatabase& database = writer.database();
    MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(database, key));
    if (map.summary.enabled && !keep) return Status::Ok();
    if (!map.summary.enabled) MAPLOC_RETURN_IF_ERROR(EnableRow(database, map.row_id));
    MAPLOC_RETURN_IF_ERROR(MarkOlderDeleted(database, key.name, keep));
    MAPLOC_RETURN_IF_ERROR(writer.CommitVisibly());
  }
  if (keep) FinishDeletions(connections);
  return Status::Ok();
}

Status DeleteSqliteVersion(SqliteConnections& connections, const MapKey& key) {
  MAPLOC_RETURN_IF_ERROR(MarkDeleted(connections, key).status());
  MAPLOC_RETURN_IF_ERROR(SweepDeletedVersions(connections));
  return GiveSpaceBack(connections);
}

void FinishDeletions(SqliteConnections& connections) {
  if (SweepDeletedVersions(connections).ok()) static_cast<void>(GiveSpaceBack(connections));
}

Status SweepDeletedVersions(SqliteConnections& connections) {
  while (true) {
    MAPLOC_ASSIGN_OR_RETURN(const bool more, DeleteOneSegment(connections));
    if (!more) return Status::Ok();
  }
}

}  // namespace maploc
