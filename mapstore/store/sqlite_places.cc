#include "mapstore/store/sqlite_places.h"

#include <string>
#include <utility>

#include "mapstore/store/codec.h"

namespace maploc {
namespace {

constexpr std::string_view kSelect =
    "SELECT landmark_count, row_count, reach, checksum, ids, row_counts, owners, descriptors "
    "FROM segment_places WHERE map = ?1 AND segment = ?2";

PlaceBlobs BlobsAt(const SqliteStatement& row) {
  PlaceBlobs blobs;
  blobs.count = row.Int("landmark_count");
  blobs.row_count = row.Int("row_count");
  blobs.reach = row.Real("reach");
  blobs.checksum = static_cast<std::uint64_t>(row.Int("checksum"));
  blobs.ids = row.Blob("ids");
  blobs.row_counts = row.Blob("row_counts");
  blobs.owners = row.Blob("owners");
  blobs.descriptors = row.Blob("descriptors");
  return blobs;
}

Result<SegmentPlace> DeriveFromLandmarks(SqliteDatabase& database, const StoredMap& map,
                                         SegmentId id) {
  MAPLOC_ASSIGN_OR_RETURN(const auto segment, ReadSegment(database, map, id));
  return PlaceOf(*segment);
}

}  // namespace

Status InsertPlace(SqliteDatabase& database, std::int64_t map, const SegmentPlace& place) {
  const PlaceBlobs blobs = EncodePlace(place);
  SqliteStatement insert(database,
                         "INSERT INTO segment_places (map, segment, landmark_count, row_count, "
                         "reach, checksum, ids, row_counts, owners, descriptors) "
                         "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)");
  return insert
      .Bind(map, place.id, blobs.count, blobs.row_count, blobs.reach,
            static_cast<std::int64_t>(blobs.checksum), blobs.ids, blobs.row_counts, blobs.owners,
            blobs.descriptors)
      .Run();
}

Result<SegmentPlace> ReadPlace(SqliteDatabase& database, const StoredMap& map, SegmentId id) {
  SqliteStatement statement(database, kSelect);
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(map.row_id, id).Step());
  // The migration to schema version 9 leaves out damaged segments. Reading one here reports the
  // damage.
  if (!found) return DeriveFromLandmarks(database, map, id);
  Result<SegmentPlace> place = DecodePlace(BlobsAt(statement), map.summary.info.point_descriptor);
  if (!place.ok()) return place.status().WithContext(WhereIs(database, map, id));
  MAPLOC_ASSIGN_OR_RETURN(SegmentSummary counts, ReadSegmentCounts(database, map, id));
  place->path_in_map = std::move(counts.path_in_map);
  place->id = id;
  return place;
}

Result<std::vector<SegmentPlace>> ReadPlaces(SqliteDatabase& database, const StoredMap& map) {
  std::vector<SegmentPlace> places;
  for (std::int64_t id = 0; id < map.summary.segments; ++id) {
    MAPLOC_ASSIGN_OR_RETURN(SegmentPlace place,
                            ReadPlace(database, map, static_cast<SegmentId>(id)));
    places.push_back(std::move(place));
  }
  return places;
}

Status WriteMissingPlaces(SqliteDatabase& database) {
  MAPLOC_ASSIGN_OR_RETURN(const auto maps, ReadAllMaps(database));
  for (const StoredMap& map : maps) {
    SqliteStatement missing(database,
                            "SELECT segment FROM segments s WHERE map = ?1 AND NOT EXISTS (SELECT "
                            "1 FROM segment_places p WHERE p.map = s.map AND "
                            "p.segment = s.segment)");
    MAPLOC_ASSIGN_OR_RETURN(const std::vector<std::int32_t> ids,
                            missing.Bind(map.row_id).Collect([](const SqliteStatement& row) {
                              return row.Int32("segment");
                            }));
    for (const std::int32_t id : ids) {
      const Result<SegmentPlace> place = DeriveFromLandmarks(database, map, id);
      // One damaged segment must not keep the whole store from being opened.
      if (place.status().code() == StatusCode::kDataLoss) continue;
      if (!place.ok()) return place.status();
      MAPLOC_RETURN_IF_ERROR(InsertPlace(database, map.row_id, *place));
    }
  }
  return Status::Ok();
}

}  // namespace maploc
