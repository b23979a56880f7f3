#include "mapstore/store/sqlite_inheritance.h"

#include "mapstore/store/sqlite_sessions.h"

namespace maploc {
namespace {

Inheritance ShareAt(const SqliteStatement& row) {
  return {row.Int("source_map"), row.Int32("source_segment"), row.Int32("segment"),
          row.Real("weight")};
}

// The same as SharesBehind, without reading all shares of the version. CROSS JOIN fixes the order
// of the join; otherwise SQLite scans the version under the write lock (MEASUREMENTS.md).
Result<std::vector<Inheritance>> ReadSharesBehind(SqliteDatabase& database, std::int64_t map,
                                                  SegmentId id) {
  SqliteStatement statement(database,
                            "SELECT i.source_map, i.source_segment, i.segment, i.weight "
                            "FROM inheritance own CROSS JOIN inheritance i "
                            "USING (map, source_map, source_segment) "
                            "WHERE own.map = ?1 AND own.segment = ?2 "
                            "ORDER BY i.segment, i.source_map, i.source_segment");
  return statement.Bind(map, id).Collect(ShareAt);
}

}  // namespace

Result<std::vector<Inheritance>> ReadInheritance(SqliteDatabase& database, std::int64_t map) {
  SqliteStatement statement(database,
                            "SELECT source_map, source_segment, segment, weight FROM inheritance "
                            "WHERE map = ?1 ORDER BY segment, source_map, source_segment");
  return statement.Bind(map).Collect(ShareAt);
}

Status InsertInheritance(SqliteDatabase& database, std::int64_t map, const Inheritance& share) {
  SqliteStatement insert(database,
                         "INSERT OR REPLACE INTO inheritance (map, segment, source_map, "
                         "source_segment, weight) VALUES (?1, ?2, ?3, ?4, ?5)");
  return insert.Bind(map, share.to, share.source, share.from, share.weight).Run();
}

Result<std::vector<std::pair<std::int64_t, SegmentId>>> ReadHeirs(SqliteDatabase& database,
                                                                  std::int64_t map, SegmentId id) {
  SqliteStatement statement(database,
                            "SELECT map, segment FROM inheritance WHERE source_map = ?1 AND "
                            "source_segment = ?2 ORDER BY map, segment");
  return statement.Bind(map, id).Collect(
      [](const SqliteStatement& row) { return std::pair(row.Int("map"), row.Int32("segment")); });
}

Result<std::vector<TrueRow>> ReadTrueRows(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                          const FoldPosition& after) {
  MAPLOC_ASSIGN_OR_RETURN(std::vector<TrueRow> own, ReadRows(database, map, id, after));
  MAPLOC_ASSIGN_OR_RETURN(const auto shares, ReadSharesBehind(database, map, id));
  std::vector<TrueRow> older;
  for (const Inheritance& share : shares) {
    if (share.to != id) continue;
    MAPLOC_ASSIGN_OR_RETURN(auto rows, ReadRows(database, share.source, share.from, after));
    for (TrueRow& row : rows) older.push_back(std::move(row));
  }
  return WithInherited(id, std::move(own), older, shares);
}

}  // namespace maploc
