#include "mapstore/store/sqlite_verify.h"

#include "mapstore/store/codec.h"
#include "mapstore/store/derivation.h"
#include "mapstore/store/sqlite_folds.h"
#include "mapstore/store/sqlite_inheritance.h"
#include "mapstore/store/sqlite_maps.h"
#include "mapstore/store/sqlite_places.h"
#include "mapstore/store/sqlite_sessions.h"
#include "mapstore/store/sqlite_states.h"

namespace maploc {
namespace {

Status Broken(const SqliteDatabase& database, const std::string& what) {
  return Status(StatusCode::kDataLoss, "DAMAGED_STORE",
                database.path() + ": " + what + "; restore it from a backup");
}

std::string NameOf(const StoredMap& map) {
  return "map '" + map.key().name + "' version " + std::to_string(map.key().version);
}

std::string NameOf(const StoredMap& map, SegmentId id) {
  return NameOf(map) + " segment " + std::to_string(id);
}

Status CheckIntegrity(SqliteDatabase& database) {
  // (1): one fault is enough to call the store damaged, and the check ends there.
  SqliteStatement integrity(database, "PRAGMA integrity_check(1)");
  MAPLOC_ASSIGN_OR_RETURN(const bool row, integrity.Step());
  if (!row || integrity.Text("integrity_check") != "ok") {
    return Broken(database,
                  "the file is damaged (" + (row ? integrity.Text("integrity_check") : "") + ")");
  }
  // integrity_check does not look at foreign keys.
  SqliteStatement keys(database, "PRAGMA foreign_key_check");
  MAPLOC_ASSIGN_OR_RETURN(const bool orphan, keys.Step());
  if (orphan) {
    return Broken(database, "a row of table " + keys.Text("table") +
                                " points to a missing row of " + keys.Text("parent"));
  }
  return Status::Ok();
}

// Each checkpoint is what the rows so far come to, to the bit, and the last row has one.
Status CheckCheckpoints(SqliteDatabase& database, const StoredMap& map, SegmentId id,
                        const SelectorOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(const auto rows, ReadTrueRows(database, map.row_id, id, BeforeAllRows()));
  MAPLOC_ASSIGN_OR_RETURN(const auto checkpoints, ReadCheckpoints(database, map.row_id, id));
  SelectorFold fold(options);
  auto next = checkpoints.begin();
  for (const TrueRow& row : rows) {
    fold.Add(row.row);
    // A checkpoint at the place of no row is never passed, so it is found below as one that is
    // left.
    if (next == checkpoints.end() || next->position != row.position()) continue;
    if (next->state != fold.state() || next->row_options != row.options ||
        next->options != rows.back().options) {
      break;
    }
    ++next;
  }
  const bool last_has_one = rows.empty() || (!checkpoints.empty() &&
                                             checkpoints.back().position == rows.back().position());
  if (next == checkpoints.end() && last_has_one) return Status::Ok();
  return Broken(database, NameOf(map, id) + ": a checkpoint differs from its sessions' rows");
}

// What is kept of a segment is what its sessions' rows and its pins say, to the bit.
Status CheckState(SqliteDatabase& database, const StoredMap& map, SegmentId id) {
  const SelectorOptions defaults;
  MAPLOC_ASSIGN_OR_RETURN(const SegmentState kept,
                          ReadSegmentState(database, map.row_id, id, defaults));
  MAPLOC_ASSIGN_OR_RETURN(const SegmentTruth truth, ReadTruth(database, map.row_id, id, defaults));
  const SegmentState derived = DeriveState(truth);
  if (derived.derived.statistics != kept.derived.statistics) {
    return Broken(database, NameOf(map, id) + ": its statistics differ from its sessions' rows");
  }
  if (derived.derived.decision != kept.derived.decision) {
    return Broken(database, NameOf(map, id) + ": its strategy differs from its sessions' rows");
  }
  if (derived.pinned != kept.pinned || derived.options != kept.options) {
    return Broken(database, NameOf(map, id) + ": its pin or its options differ from what was set");
  }
  return CheckCheckpoints(database, map, id, truth.options);
}

// What is kept for place recognition is what the segment says, to the bit.
Status CheckPlace(SqliteDatabase& database, const StoredMap& map, const Segment& segment) {
  MAPLOC_ASSIGN_OR_RETURN(const SegmentPlace kept, ReadPlace(database, map, segment.id));
  // The checksum covers all that is stored of a place. The path is read from the segment itself.
  if (EncodePlace(kept).checksum == EncodePlace(PlaceOf(segment)).checksum) return Status::Ok();
  return Broken(database, NameOf(map, segment.id) + ": its place differs from its landmarks");
}

Status CheckSegment(SqliteDatabase& database, const StoredMap& map, SegmentId id,
                    LandmarkCounter& counter) {
  MAPLOC_ASSIGN_OR_RETURN(const auto segment, ReadSegment(database, map, id));
  MAPLOC_ASSIGN_OR_RETURN(const SegmentSummary counts, ReadSegmentCounts(database, map, id));
  if (counts.usable_lines != CountUsableLines(segment->lines)) {
    return Broken(database, NameOf(map, id) + ": its count of usable lines is wrong");
  }
  MAPLOC_RETURN_IF_ERROR(CheckPlace(database, map, *segment));
  counter.Add(*segment);
  return CheckState(database, map, id);
}

// Shares go to one version at most whole, and come from older versions of the same map.
Status CheckInheritance(SqliteDatabase& database, const StoredMap& map) {
  // Weights are rounded, so their sum may exceed 1 by a little.
  SqliteStatement shares(database,
                         "SELECT source_segment FROM inheritance WHERE map = ?1 "
                         "GROUP BY source_map, source_segment HAVING SUM(weight) > 1.000001");
  MAPLOC_ASSIGN_OR_RETURN(const bool twice, shares.Bind(map.row_id).Step());
  if (twice) return Broken(database, NameOf(map) + ": inherits an older segment's rows twice");
  SqliteStatement sources(database,
                          "SELECT 1 FROM inheritance i JOIN map_versions m ON m.id = i.source_map "
                          "WHERE i.map = ?1 AND (m.name <> ?2 OR m.version >= ?3)");
  MAPLOC_ASSIGN_OR_RETURN(const bool strange,
                          sources.Bind(map.row_id, map.key().name, map.key().version).Step());
  if (strange) return Broken(database, NameOf(map) + ": inherits from what is no older version");
  return Status::Ok();
}

Status CheckMap(SqliteDatabase& database, const StoredMap& map) {
  SqliteStatement count(database, "SELECT COUNT(*) AS count FROM segments WHERE map = ?1");
  MAPLOC_ASSIGN_OR_RETURN(const bool row, count.Bind(map.row_id).Step());
  if (!row || count.Int("count") != map.summary.segments) {
    return Broken(database, NameOf(map) + ": its count of segments is wrong");
  }
  LandmarkCounter counter;
  for (std::int64_t id = 0; id < map.summary.segments; ++id) {
    MAPLOC_RETURN_IF_ERROR(CheckSegment(database, map, static_cast<SegmentId>(id), counter));
  }
  MAPLOC_RETURN_IF_ERROR(CheckInheritance(database, map));
  MapSummary counted;
  counter.CountInto(counted);
  const MapSummary& stored = map.summary;
  if (counted.points != stored.points || counted.lines != stored.lines ||
      counted.usable_lines != stored.usable_lines) {
    return Broken(database, NameOf(map) + ": its counts of landmarks are wrong");
  }
  return Status::Ok();
}

Status CheckSession(SqliteDatabase& database, const Session& session) {
  const std::string name = "session '" + session.id + "'";
  MAPLOC_ASSIGN_OR_RETURN(const auto observations, ReadObservations(database, session.id));
  MAPLOC_ASSIGN_OR_RETURN(const auto rows, ReadRowsOfSession(database, session.id));
  if (session.end == SessionEnd::kOpen) {
    if (rows.empty()) return Status::Ok();
    return Broken(database, name + ": is open but counted");
  }
  if (rows != FoldObservations(session, observations)) {
    return Broken(database, name + ": its rows differ from its queries");
  }
  MAPLOC_ASSIGN_OR_RETURN(const SessionSummary kept, ReadSummary(database, session));
  const SessionSummary counted = SummarizeSession(session.id, session.end, observations, rows);
  // The strategies are left out: they are kept as they were answered and cannot be derived again.
  if (kept.queries != counted.queries || kept.localized != counted.localized) {
    return Broken(database, name + ": its summary differs from its queries");
  }
  return Status::Ok();
}

}  // namespace

Status VerifySqliteStore(SqliteConnections& connections) {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections.Read());
  SqliteDatabase& database = reader.database();
  MAPLOC_RETURN_IF_ERROR(CheckIntegrity(database));
  MAPLOC_ASSIGN_OR_RETURN(const auto maps, ReadAllMaps(database));
  for (const StoredMap& map : maps) MAPLOC_RETURN_IF_ERROR(CheckMap(database, map));
  MAPLOC_ASSIGN_OR_RETURN(const auto sessions, ReadSessions(database));
  for (const Session& session : sessions) MAPLOC_RETURN_IF_ERROR(CheckSession(database, session));
  return Status::Ok();
}

}  // namespace maploc
