#include "mapstore/store/sqlite_maps.h"

#include "mapstore/store/codec.h"
#include "mapstore/store/validation.h"

namespace maploc {
namespace {

// `enabled_order > 0`: a name of which all versions are staged has no enabled version.
constexpr std::string_view kMapColumns =
    "id, name, version, metric, scale, rotation_x, rotation_y, rotation_z, rotation_w, "
    "translation_x, translation_y, translation_z, point_kind, point_kind_bytes, "
    "point_kind_metric, line_kind, line_kind_bytes, line_kind_metric, created_unix_ns, "
    "segment_count, point_count, line_count, usable_line_count, shared_error_rad, enabled_order, "
    "enabled_order > 0 AND enabled_order = (SELECT MAX(enabled_order) FROM map_versions others "
    "WHERE others.name = map_versions.name) AS enabled";

std::string SelectMaps(std::string_view rest) {
  return "SELECT " + std::string(kMapColumns) + " FROM map_versions WHERE state = 1 " +
         std::string(rest);
}

DescriptorKind KindAt(const SqliteStatement& row, ColumnName kind, ColumnName bytes,
                      ColumnName metric) {
  return {row.Text(kind), row.Int32(bytes), row.Enum<DescriptorMetric>(metric)};
}

Similarity3 SimilarityAt(const SqliteStatement& row) {
  Similarity3 transform;
  transform.scale = row.Real("scale");
  transform.rotation = Eigen::Quaterniond(row.Real("rotation_w"), row.Real("rotation_x"),
                                          row.Real("rotation_y"), row.Real("rotation_z"));
  transform.translation = {row.Real("translation_x"), row.Real("translation_y"),
                           row.Real("translation_z")};
  return transform;
}

StoredMap MapAt(const SqliteStatement& row) {
  StoredMap map;
  map.row_id = row.Int("id");
  MapInfo& info = map.summary.info;
  info.key = {row.Text("name"), row.Int("version")};
  info.metric = row.Bool("metric");
  info.map_from_source = SimilarityAt(row);
  info.point_descriptor = KindAt(row, "point_kind", "point_kind_bytes", "point_kind_metric");
  info.line_descriptor = KindAt(row, "line_kind", "line_kind_bytes", "line_kind_metric");
  info.created_unix_ns = row.Int("created_unix_ns");
  map.summary.segments = row.Int("segment_count");
  map.summary.points = row.Int("point_count");
  map.summary.lines = row.Int("line_count");
  map.summary.usable_lines = row.Int("usable_line_count");
  info.shared_error_rad = row.Real("shared_error_rad");
  map.summary.enabled = row.Bool("enabled");
  map.summary.enabled_order = row.Int("enabled_order");
  return map;
}

// The blobs of one type (1 points, 2 lines) of a segment.
Result<FeatureBlobs> ReadFeatures(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                  int type) {
  SqliteStatement statement(
      database,
      "SELECT landmark_count, descriptor_count, checksum, ids, geometry, owners, "
      "descriptors, viewing FROM segment_features WHERE map = ?1 AND segment = ?2 AND "
      "type = ?3");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(map, id, type).Step());
  if (!found) {
    return Status(StatusCode::kDataLoss, "DAMAGED_SEGMENT",
                  std::string(type == 1 ? "points" : "lines") + ": are missing");
  }
  FeatureBlobs blobs;
  blobs.count = statement.Int("landmark_count");
  blobs.descriptor_count = statement.Int("descriptor_count");
  blobs.checksum = static_cast<std::uint64_t>(statement.Int("checksum"));
  blobs.ids = statement.Blob("ids");
  blobs.geometry = statement.Blob("geometry");
  blobs.owners = statement.Blob("owners");
  blobs.descriptors = statement.Blob("descriptors");
  blobs.viewing = statement.Blob("viewing");
  return blobs;
}

Result<std::shared_ptr<const Segment>> DecodeSegment(SqliteDatabase& database, const StoredMap& map,
                                                     SegmentId id,
                                                     std::vector<Eigen::Vector3d> path) {
  auto segment = std::make_shared<Segment>();
  segment->map = map.key();
  segment->id = id;
  segment->path_in_map = std::move(path);
  MAPLOC_ASSIGN_OR_RETURN(const FeatureBlobs points, ReadFeatures(database, map.row_id, id, 1));
  MAPLOC_ASSIGN_OR_RETURN(segment->points, DecodePoints(points, map.summary.info.point_descriptor));
  MAPLOC_ASSIGN_OR_RETURN(const FeatureBlobs lines, ReadFeatures(database, map.row_id, id, 2));
  MAPLOC_ASSIGN_OR_RETURN(segment->lines, DecodeLines(lines, map.summary.info.line_descriptor));
  if (const Status valid = ValidateSegment(map.summary.info, *segment); !valid.ok()) {
    return Status(StatusCode::kDataLoss, "DAMAGED_SEGMENT", valid.message());
  }
  return std::shared_ptr<const Segment>(std::move(segment));
}

}  // namespace

Result<std::vector<StoredMap>> ReadAllMaps(SqliteDatabase& database) {
  SqliteStatement statement(database, SelectMaps("AND deleted = 0 ORDER BY name, version"));
  return statement.Collect(MapAt);
}

Result<StoredMap> ReadEnabledMap(SqliteDatabase& database, const std::string& name) {
  SqliteStatement statement(database, SelectMaps("AND name = ?1 AND enabled"));
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(name).Step());
  if (found) return MapAt(statement);
  // Only for the error: a name without an enabled version has another cure than an unknown name.
  SqliteStatement any(database, SelectMaps("AND deleted = 0 AND name = ?1 LIMIT 1"));
  MAPLOC_ASSIGN_OR_RETURN(const bool disabled, any.Bind(name).Step());
  return disabled ? NoVersionEnabled(name) : UnknownMap(name);
}

Result<StoredMap> ReadMap(SqliteDatabase& database, const MapKey& key) {
  SqliteStatement statement(database, SelectMaps("AND deleted = 0 AND name = ?1 AND version = ?2"));
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(key.name, key.version).Step());
  if (!found) return UnknownMap(key);
  return MapAt(statement);
}

Result<StoredMap> ReadMapOfSession(SqliteDatabase& database, const Session& session) {
  SqliteStatement statement(database, SelectMaps("AND name = ?1 AND version = ?2"));
  const MapKey& key = session.map;
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(key.name, key.version).Step());
  if (!found) return UnknownMap(key);
  return MapAt(statement);
}

Result<SegmentSummary> ReadSegmentCounts(SqliteDatabase& database, const StoredMap& map,
                                         SegmentId id) {
  SqliteStatement statement(
      database,
      "SELECT s.usable_line_count, s.path_count, s.path, "
      "(SELECT landmark_count FROM segment_features f "
      " WHERE f.map = s.map AND f.segment = s.segment AND f.type = 1) AS points, "
      "(SELECT landmark_count FROM segment_features f "
      " WHERE f.map = s.map AND f.segment = s.segment AND f.type = 2) AS lines "
      "FROM segments s WHERE s.map = ?1 AND s.segment = ?2");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(map.row_id, id).Step());
  if (!found) return UnknownSegment(map.key(), id);
  SegmentSummary summary;
  summary.id = id;
  summary.usable_lines = statement.Int("usable_line_count");
  MAPLOC_ASSIGN_OR_RETURN(
      summary.path_in_map,
      DecodePositions(statement.Bytes("path"), statement.Int("path_count"), "path"));
  summary.points = statement.Int("points");
  summary.lines = statement.Int("lines");
  return summary;
}

Status RequireSegment(SqliteDatabase& database, const StoredMap& map, SegmentId id) {
  SqliteStatement statement(database, "SELECT 1 FROM segments WHERE map = ?1 AND segment = ?2");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(map.row_id, id).Step());
  return found ? Status::Ok() : UnknownSegment(map.key(), id);
}

std::string WhereIs(const SqliteDatabase& database, const StoredMap& map, SegmentId id) {
  return database.path() + ": map '" + map.key().name + "' version " +
         std::to_string(map.key().version) + " segment " + std::to_string(id);
}

Result<std::shared_ptr<const Segment>> ReadSegment(SqliteDatabase& database, const StoredMap& map,
                                                   SegmentId id) {
  const std::string where = WhereIs(database, map, id);
  Result<SegmentSummary> counts = ReadSegmentCounts(database, map, id);
  if (!counts.ok()) {
    // NOT_FOUND names map and segment already.
    const bool damaged = counts.status().code() == StatusCode::kDataLoss;
    return damaged ? counts.status().WithContext(where) : counts.status();
  }
  Result<std::shared_ptr<const Segment>> segment =
      DecodeSegment(database, map, id, std::move(counts->path_in_map));
  if (!segment.ok()) return segment.status().WithContext(where);
  return segment;
}

}  // namespace maploc
