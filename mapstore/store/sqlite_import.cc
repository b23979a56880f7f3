#include "mapstore/store/sqlite_import.h"

#include <vector>

#include "mapstore/store/codec.h"
#include "mapstore/store/derivation.h"
#include "mapstore/store/import_lock.h"
#include "mapstore/store/sqlite_inheritance.h"
#include "mapstore/store/sqlite_maps.h"
#include "mapstore/store/sqlite_places.h"
#include "mapstore/store/sqlite_states.h"
#include "mapstore/store/sqlite_versions.h"
#include "mapstore/store/validation.h"

namespace maploc {
namespace {

constexpr int kPointsType = 1;
constexpr int kLinesType = 2;

Status InsertFeatures(SqliteDatabase& database, std::int64_t map, SegmentId id, int type,
                      const FeatureBlobs& blobs) {
  SqliteStatement insert(database,
                         "INSERT INTO segment_features (map, segment, type, landmark_count, "
                         "descriptor_count, checksum, ids, geometry, owners, descriptors, "
                         "viewing) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)");
  return insert
      .Bind(map, id, type, blobs.count, blobs.descriptor_count,
            static_cast<std::int64_t>(blobs.checksum), blobs.ids, blobs.geometry, blobs.owners,
            blobs.descriptors, blobs.viewing)
      .Run();
}

Status InsertSegment(SqliteDatabase& database, std::int64_t map, const Segment& segment) {
  SqliteStatement insert(database,
                         "INSERT INTO segments (map, segment, usable_line_count, path_count, path) "
                         "VALUES (?1, ?2, ?3, ?4, ?5)");
  return insert
      .Bind(map, segment.id, CountUsableLines(segment.lines),
            static_cast<std::int64_t>(segment.path_in_map.size()),
            EncodePositions(segment.path_in_map))
      .Run();
}

// Deleted versions keep their row, so that their numbers are not used again.
Result<std::int64_t> NextVersion(SqliteDatabase& database, const std::string& name) {
  SqliteStatement statement(
      database, "SELECT COALESCE(MAX(version), 0) + 1 AS next FROM map_versions WHERE name = ?1");
  MAPLOC_ASSIGN_OR_RETURN(const bool row, statement.Bind(name).Step());
  return row ? statement.Int("next") : 1;
}

Result<std::int64_t> InsertMap(SqliteDatabase& database, const MapInfo& info) {
  SqliteStatement insert(
      database,
      "INSERT INTO map_versions (name, version, state, metric, scale, rotation_x, rotation_y, "
      "rotation_z, rotation_w, translation_x, translation_y, translation_z, point_kind, "
      "point_kind_bytes, point_kind_metric, line_kind, line_kind_bytes, line_kind_metric, "
      "created_unix_ns, shared_error_rad) VALUES (?1, ?2, 0, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, "
      "?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19)");
  const Similarity3& transform = info.map_from_source;
  const DescriptorKind& points = info.point_descriptor;
  const DescriptorKind& lines = info.line_descriptor;
  MAPLOC_RETURN_IF_ERROR(insert
                             .Bind(info.key.name, info.key.version, info.metric, transform.scale,
                                   transform.rotation.x(), transform.rotation.y(),
                                   transform.rotation.z(), transform.rotation.w(),
                                   transform.translation.x(), transform.translation.y(),
                                   transform.translation.z(), points.name, points.bytes,
                                   static_cast<std::int64_t>(points.metric), lines.name,
                                   lines.bytes, static_cast<std::int64_t>(lines.metric),
                                   info.created_unix_ns, info.shared_error_rad)
                             .Run());
  return database.LastInsertId();
}

enum class ImportOwner { kThisWriter, kUnknown };

// Asked in the transaction that deletes, because since an earlier look the import may have been
// published or removed. BeginSqliteImport takes the lock before it commits the row, so a row
// without a lock was left by a dead import.
Result<bool> MayDelete(const SqliteConnections& connections, SqliteDatabase& database,
                       std::int64_t map, ImportOwner owner) {
  SqliteStatement find(database, "SELECT 1 FROM map_versions WHERE id = ?1 AND state = 0");
  MAPLOC_ASSIGN_OR_RETURN(const bool unpublished, find.Bind(map).Step());
  if (!unpublished || owner == ImportOwner::kThisWriter) return unpublished;
  MAPLOC_ASSIGN_OR_RETURN(const bool alive, ImportLock::IsHeld(connections.path(), map));
  return !alive;
}

// The segments of an import that was never published go one by one, so that nobody waits long for
// the write lock; the version itself goes last, so that an interrupted sweep can be taken up again.
Status DeleteImport(SqliteConnections& connections, std::int64_t map, ImportOwner owner) {
  while (true) {
    MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
    MAPLOC_ASSIGN_OR_RETURN(const bool may, MayDelete(connections, writer.database(), map, owner));
    if (!may) return Status::Ok();
    SqliteStatement find(writer.database(),
                         "SELECT MIN(segment) AS first FROM segments WHERE map = ?1");
    MAPLOC_ASSIGN_OR_RETURN(const bool row, find.Bind(map).Step());
    if (!row || find.IsNull("first")) {
      SqliteStatement remove(writer.database(), "DELETE FROM map_versions WHERE id = ?1");
      MAPLOC_RETURN_IF_ERROR(remove.Bind(map).Run());
      return writer.Commit();
    }
    const std::int64_t segment = find.Int("first");
    // States, checkpoints and weights are there if the import ended after Inherit. All rows that
    // refer to the segment go before it, because SQLite checks foreign keys at each statement.
    for (const char* sql : {"DELETE FROM segment_states WHERE map = ?1 AND segment = ?2",
                            "DELETE FROM segment_folds WHERE map = ?1 AND segment = ?2",
                            "DELETE FROM inheritance WHERE map = ?1 AND segment = ?2",
                            "DELETE FROM segment_features WHERE map = ?1 AND segment = ?2",
                            "DELETE FROM segment_places WHERE map = ?1 AND segment = ?2",
                            "DELETE FROM segments WHERE map = ?1 AND segment = ?2"}) {
      SqliteStatement remove(writer.database(), sql);
      MAPLOC_RETURN_IF_ERROR(remove.Bind(map, segment).Run());
    }
    MAPLOC_RETURN_IF_ERROR(writer.Commit());
  }
}

// The enabled version: what sessions teach now. Else the newest one before. Null: there is none.
const StoredMap* FindPredecessor(const std::vector<StoredMap>& by_version, const MapKey& heir) {
  const StoredMap* predecessor = nullptr;
  for (const StoredMap& other : by_version) {
    const MapKey& key = other.key();
    if (key.name != heir.name || key.version >= heir.version) continue;
    if (predecessor == nullptr || !predecessor->summary.enabled) predecessor = &other;
  }
  return predecessor;
}

// What the version of `places` inherits. Nothing where its predecessor is damaged: a new map must
// not fail for an old one's sake.
Result<std::vector<Inheritance>> FindInheritance(SqliteConnections& connections,
                                                 const MapInfo& info,
                                                 std::span<const Segment> places) {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections.Read());
  SqliteDatabase& database = reader.database();
  MAPLOC_ASSIGN_OR_RETURN(const auto maps, ReadAllMaps(database));
  const StoredMap* predecessor = FindPredecessor(maps, info.key);
  if (predecessor == nullptr) return std::vector<Inheritance>();
  std::vector<Segment> old_places;
  for (std::int64_t id = 0; id < predecessor->summary.segments; ++id) {
    const auto segment = ReadSegment(database, *predecessor, static_cast<SegmentId>(id));
    if (segment.status().code() == StatusCode::kDataLoss) return std::vector<Inheritance>();
    if (!segment.ok()) return segment.status();
    old_places.push_back(WithoutDescriptors(**segment));
  }
  MAPLOC_ASSIGN_OR_RETURN(const auto older, ReadInheritance(database, predecessor->row_id));
  return InheritFrom(predecessor->row_id, predecessor->summary.info, old_places, older, info,
                     places);
}

class SqliteMapWriter : public MapWriter {
 public:
  SqliteMapWriter(SqliteConnections& connections, MapInfo info, std::int64_t row_id,
                  ImportLock lock)
      : connections_(connections),
        info_(std::move(info)),
        row_id_(row_id),
        lock_(std::move(lock)) {}

  ~SqliteMapWriter() override {
    // What cannot be deleted now is swept at the next start.
    if (!committed_) {
      static_cast<void>(DeleteImport(connections_, row_id_, ImportOwner::kThisWriter));
    }
  }

  const MapKey& key() const override { return info_.key; }

  Status AddSegment(const Segment& segment) override {
    if (committed_) return ImportCommitted();
    MAPLOC_RETURN_IF_ERROR(ValidateNextSegment(info_, segment, next_));
    // Encoded before the write lock is taken, because others wait for it.
    const FeatureBlobs points = EncodePoints(segment.points);
    const FeatureBlobs lines = EncodeLines(segment.lines);
    const SegmentPlace place = PlaceOf(segment);
    MAPLOC_ASSIGN_OR_RETURN(auto writer, connections_.Write());
    SqliteDatabase& database = writer.database();
    MAPLOC_RETURN_IF_ERROR(InsertSegment(database, row_id_, segment));
    MAPLOC_RETURN_IF_ERROR(InsertFeatures(database, row_id_, segment.id, kPointsType, points));
    MAPLOC_RETURN_IF_ERROR(InsertFeatures(database, row_id_, segment.id, kLinesType, lines));
    MAPLOC_RETURN_IF_ERROR(InsertPlace(database, row_id_, place));
    MAPLOC_RETURN_IF_ERROR(writer.Commit());
    // Only after the commit: a segment that was not stored must not be counted.
    counter_.Add(segment);
    places_.push_back(WithoutDescriptors(segment));
    ++next_;
    return Status::Ok();
  }

  Status Commit(const Publishing& publishing) override {
    if (committed_) return ImportCommitted();
    if (next_ == 0) return EmptyMap(info_.key);
    MAPLOC_RETURN_IF_ERROR(Inherit());
    MAPLOC_RETURN_IF_ERROR(Publish(publishing));
    committed_ = true;
    if (publishing.keep_versions) FinishDeletions(connections_);
    return Status::Ok();
  }

 private:
  Status Publish(const Publishing& publishing) {
    MapSummary summary;
    counter_.CountInto(summary);
    MAPLOC_ASSIGN_OR_RETURN(auto writer, connections_.Write());
    SqliteStatement publish(writer.database(),
                            "UPDATE map_versions SET state = 1, segment_count = ?2, point_count = "
                            "?3, line_count = ?4, usable_line_count = ?5 WHERE id = ?1");
    MAPLOC_RETURN_IF_ERROR(
        publish.Bind(row_id_, summary.segments, summary.points, summary.lines, summary.usable_lines)
            .Run());
    if (publishing.enable) MAPLOC_RETURN_IF_ERROR(EnableUnlessOld(writer.database()));
    MAPLOC_RETURN_IF_ERROR(
        MarkOlderDeleted(writer.database(), info_.key.name, publishing.keep_versions));
    return writer.CommitVisibly();
  }

  // Two imports at once: the one that began later is newer, whichever ends first.
  Status EnableUnlessOld(SqliteDatabase& database) {
    const Result<StoredMap> enabled = ReadEnabledMap(database, info_.key.name);
    if (enabled.status().code() == StatusCode::kNotFound) return EnableRow(database, row_id_);
    if (!enabled.ok()) return enabled.status();
    const bool is_old = enabled->key().version > info_.key.version;
    return is_old ? Status::Ok() : EnableRow(database, row_id_);
  }

  // All weights first, because what a segment gets depends on its fellow heirs. Then one short
  // transaction a segment: with many sessions a whole map would keep others waiting. What sessions
  // teach the older versions meanwhile reaches the heirs that are written down.
  Status Inherit() {
    MAPLOC_ASSIGN_OR_RETURN(const auto shares, FindInheritance(connections_, info_, places_));
    MAPLOC_RETURN_IF_ERROR(WriteDown(shares));
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const SegmentId heir = shares[i].to;
      // Shares are sorted by heir, so an heir's shares are neighbours.
      if (i > 0 && shares[i - 1].to == heir) continue;
      MAPLOC_ASSIGN_OR_RETURN(auto writer, connections_.Write());
      MAPLOC_RETURN_IF_ERROR(DeriveAnew(writer.database(), row_id_, heir,
                                        connections_.options().selector, BeforeAllRows())
                                 .status());
      MAPLOC_RETURN_IF_ERROR(writer.Commit());
    }
    return Status::Ok();
  }

  Status WriteDown(std::span<const Inheritance> shares) {
    if (shares.empty()) return Status::Ok();
    MAPLOC_ASSIGN_OR_RETURN(auto writer, connections_.Write());
    for (const Inheritance& share : shares) {
      MAPLOC_RETURN_IF_ERROR(InsertInheritance(writer.database(), row_id_, share));
    }
    return writer.Commit();
  }

  SqliteConnections& connections_;
  const MapInfo info_;
  const std::int64_t row_id_;
  const ImportLock lock_;
  LandmarkCounter counter_;
  std::vector<Segment> places_;  // of the segments so far, without descriptors
  SegmentId next_ = 0;
  bool committed_ = false;
};

Result<std::vector<std::int64_t>> UnpublishedMaps(SqliteConnections& connections) {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections.Read());
  SqliteStatement statement(reader.database(), "SELECT id FROM map_versions WHERE state = 0");
  return statement.Collect([](const SqliteStatement& row) { return row.Int("id"); });
}

}  // namespace

Result<std::unique_ptr<MapWriter>> BeginSqliteImport(SqliteConnections& connections,
                                                     const MapInfo& info) {
  MAPLOC_RETURN_IF_ERROR(ValidateMapInfo(info));
  // Without a server nobody else removes what killed imports have left.
  MAPLOC_RETURN_IF_ERROR(SweepSqliteImports(connections));
  MapInfo named = info;
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
  MAPLOC_ASSIGN_OR_RETURN(named.key.version, NextVersion(writer.database(), info.key.name));
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t row_id, InsertMap(writer.database(), named));
  // Before the commit, so that no other process sees the row without its lock and deletes it.
  MAPLOC_ASSIGN_OR_RETURN(ImportLock lock, ImportLock::Acquire(connections.path(), row_id));
  MAPLOC_RETURN_IF_ERROR(writer.Commit());
  return std::unique_ptr<MapWriter>(
      std::make_unique<SqliteMapWriter>(connections, std::move(named), row_id, std::move(lock)));
}

Status SweepSqliteImport(SqliteConnections& connections, std::int64_t map) {
  return DeleteImport(connections, map, ImportOwner::kUnknown);
}

Status SweepSqliteImports(SqliteConnections& connections) {
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<std::int64_t> maps, UnpublishedMaps(connections));
  for (const std::int64_t map : maps) {
    // This look only saves taking the write lock. DeleteImport decides in its own transaction.
    MAPLOC_ASSIGN_OR_RETURN(const bool alive, ImportLock::IsHeld(connections.path(), map));
    if (!alive) MAPLOC_RETURN_IF_ERROR(SweepSqliteImport(connections, map));
  }
  return SweepDeletedVersions(connections);
}

}  // namespace maploc
