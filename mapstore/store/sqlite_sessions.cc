#include "mapstore/store/sqlite_sessions.h"

#include "mapstore/store/validation.h"

namespace maploc {
namespace {

constexpr std::string_view kSessionColumns =
    "s.id, m.name, m.version, s.robot, s.start_unix_ns, s.end_unix_ns, s.end, s.revoked";

Session SessionAt(const SqliteStatement& row) {
  Session session;
  session.id = row.Text("id");
  session.map = {row.Text("name"), row.Int("version")};
  session.robot = row.Text("robot");
  session.start_unix_ns = row.Int("start_unix_ns");
  session.end_unix_ns = row.Int("end_unix_ns");
  session.end = row.Enum<SessionEnd>("end");
  session.revoked = row.Bool("revoked");
  return session;
}

Status ReadLabels(SqliteDatabase& database, Session& session) {
  SqliteStatement statement(database, "SELECT name, value FROM session_labels WHERE session = ?1");
  statement.Bind(session.id);
  while (true) {
    MAPLOC_ASSIGN_OR_RETURN(const bool row, statement.Step());
    if (!row) return Status::Ok();
    session.labels[statement.Text("name")] = statement.Text("value");
  }
}

FeatureCounts CountsAt(const SqliteStatement& row, ColumnName matches, ColumnName inliers) {
  return {row.Int32(matches), row.Int32(inliers)};
}

// In the order in which InsertObservation binds them.
constexpr std::string_view kObservationColumns =
    "session, sequence, segment, outcome, point_matches, point_inliers, usable_line_matches, "
    "usable_line_inliers, vertical_line_matches, vertical_line_inliers, strategy, fell_back, "
    "iterations, gravity_disagreement_rad, confidence, total_ms, time_unix_ns, inlier_rms_pixels, "
    "gravity_rejected, gravity_tilt_x_rad, gravity_tilt_y_rad, request_id";

Observation ObservationAt(const SqliteStatement& row) {
  Observation observation;
  observation.sequence = row.Int("sequence");
  observation.segment = row.Int32("segment");
  observation.outcome = row.Enum<Outcome>("outcome");
  Evidence& evidence = observation.evidence;
  evidence.points = CountsAt(row, "point_matches", "point_inliers");
  evidence.usable_lines = CountsAt(row, "usable_line_matches", "usable_line_inliers");
  evidence.vertical_lines = CountsAt(row, "vertical_line_matches", "vertical_line_inliers");
  evidence.strategy = row.Enum<Strategy>("strategy");
  evidence.fell_back = row.Bool("fell_back");
  evidence.iterations = row.Int32("iterations");
  evidence.gravity_disagreement_rad = row.Real("gravity_disagreement_rad");
  evidence.confidence = row.Real("confidence");
  observation.total_ms = row.Real("total_ms");
  observation.time_unix_ns = row.Int("time_unix_ns");
  evidence.inlier_rms_px = row.Real("inlier_rms_pixels");
  evidence.gravity_rejected = row.Bool("gravity_rejected");
  evidence.gravity_tilt_rad = {row.Real("gravity_tilt_x_rad"), row.Real("gravity_tilt_y_rad")};
  observation.counted_as = row.Text("request_id");
  return observation;
}

Status InsertObservation(SqliteStatement& insert, const SessionId& id, const Observation& o) {
  const Evidence& evidence = o.evidence;
  return insert
      .Bind(id, o.sequence, o.segment, static_cast<std::int64_t>(o.outcome),
            evidence.points.matches, evidence.points.inliers, evidence.usable_lines.matches,
            evidence.usable_lines.inliers, evidence.vertical_lines.matches,
            evidence.vertical_lines.inliers, static_cast<std::int64_t>(evidence.strategy),
            evidence.fell_back, evidence.iterations, evidence.gravity_disagreement_rad,
            evidence.confidence, o.total_ms, o.time_unix_ns, evidence.inlier_rms_px,
            evidence.gravity_rejected, evidence.gravity_tilt_rad.x(), evidence.gravity_tilt_rad.y(),
            o.counted_as)
      .Run();
}

SessionSummary::SegmentChange ChangeAt(const SqliteStatement& row) {
  return {row.Int32("segment"), row.Int("queries"), row.Int("localized"),
          row.Enum<Strategy>("strategy_before"), row.Enum<Strategy>("strategy_after")};
}

constexpr std::string_view kRowColumns =
    "r.session, s.start_unix_ns, r.segment, r.queries, r.localized, r.point_matches, "
    "r.point_inliers, r.usable_line_matches, r.usable_line_inliers, r.vertical_line_matches, "
    "r.vertical_line_inliers, r.median_point_matches, r.median_usable_line_matches, "
    "r.median_vertical_line_matches";

SegmentSessionRow RowAt(const SqliteStatement& statement) {
  SegmentSessionRow row;
  row.session = statement.Text("session");
  row.session_start_unix_ns = statement.Int("start_unix_ns");
  row.segment = statement.Int32("segment");
  row.queries = statement.Int("queries");
  row.localized = statement.Int("localized");
  row.point_matches = statement.Int("point_matches");
  row.point_inliers = statement.Int("point_inliers");
  row.usable_line_matches = statement.Int("usable_line_matches");
  row.usable_line_inliers = statement.Int("usable_line_inliers");
  row.vertical_line_matches = statement.Int("vertical_line_matches");
  row.vertical_line_inliers = statement.Int("vertical_line_inliers");
  row.median_point_matches = statement.Real("median_point_matches");
  row.median_usable_line_matches = statement.Real("median_usable_line_matches");
  row.median_vertical_line_matches = statement.Real("median_vertical_line_matches");
  return row;
}

}  // namespace

Status InsertSession(SqliteDatabase& database, const StoredMap& map, const Session& session) {
  // DO NOTHING, so that a known id can be told from other constraints that fail.
  SqliteStatement insert(database,
                         "INSERT INTO sessions (id, map, robot, start_unix_ns, end_unix_ns, end, "
                         "revoked) VALUES (?1, ?2, ?3, ?4, 0, 0, 0) ON CONFLICT DO NOTHING");
  MAPLOC_RETURN_IF_ERROR(
      insert.Bind(session.id, map.row_id, session.robot, session.start_unix_ns).Run());
  if (database.ChangedRows() == 0) return SessionExists(session.id);
  SqliteStatement label(database, "INSERT INTO session_labels VALUES (?1, ?2, ?3)");
  for (const auto& [name, value] : session.labels) {
    MAPLOC_RETURN_IF_ERROR(label.Bind(session.id, name, value).Run());
  }
  return Status::Ok();
}

Result<Session> ReadSession(SqliteDatabase& database, const SessionId& id) {
  SqliteStatement statement(database, "SELECT " + std::string(kSessionColumns) +
                                          " FROM sessions s JOIN map_versions m ON m.id = s.map "
                                          "WHERE s.id = ?1");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(id).Step());
  if (!found) return UnknownSession(id);
  Session session = SessionAt(statement);
  MAPLOC_RETURN_IF_ERROR(ReadLabels(database, session));
  return session;
}

Result<std::vector<Session>> ReadSessions(SqliteDatabase& database) {
  SqliteStatement statement(database, "SELECT " + std::string(kSessionColumns) +
                                          " FROM sessions s JOIN map_versions m ON m.id = s.map "
                                          "ORDER BY s.start_unix_ns, s.id");
  std::vector<Session> sessions;
  while (true) {
    MAPLOC_ASSIGN_OR_RETURN(const bool row, statement.Step());
    if (!row) return sessions;
    sessions.push_back(SessionAt(statement));
    MAPLOC_RETURN_IF_ERROR(ReadLabels(database, sessions.back()));
  }
}

Status MarkRevoked(SqliteDatabase& database, const SessionId& id, bool revoked) {
  SqliteStatement statement(database, "UPDATE sessions SET revoked = ?2 WHERE id = ?1");
  return statement.Bind(id, revoked).Run();
}

Status CloseSession(SqliteDatabase& database, const SessionSummary& summary,
                    std::int64_t end_unix_ns) {
  SqliteStatement statement(database,
                            "UPDATE sessions SET end = ?2, end_unix_ns = ?3, queries = ?4, "
                            "localized = ?5 WHERE id = ?1");
  return statement
      .Bind(summary.session, static_cast<std::int64_t>(summary.end), end_unix_ns, summary.queries,
            summary.localized)
      .Run();
}

Result<SessionSummary> ReadSummary(SqliteDatabase& database, const Session& session) {
  SessionSummary summary;
  summary.session = session.id;
  summary.end = session.end;
  SqliteStatement totals(database, "SELECT queries, localized FROM sessions WHERE id = ?1");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, totals.Bind(session.id).Step());
  if (!found) return UnknownSession(session.id);
  summary.queries = totals.Int("queries");
  summary.localized = totals.Int("localized");
  SqliteStatement changes(database,
                          "SELECT segment, queries, localized, strategy_before, strategy_after "
                          "FROM segment_sessions WHERE session = ?1 ORDER BY segment");
  MAPLOC_ASSIGN_OR_RETURN(summary.segments, changes.Bind(session.id).Collect(ChangeAt));
  return summary;
}

Status InsertObservations(SqliteDatabase& database, const StoredMap& map, const SessionId& id,
                          std::span<const Observation> observations) {
  // Appending twice stores once: a sequence that is known keeps what it has.
  const std::string columns(kObservationColumns);
  SqliteStatement insert(database, "INSERT INTO observations (" + columns + ") VALUES " +
                                       ParametersFor(columns) + " ON CONFLICT DO NOTHING");
  for (const Observation& observation : observations) {
    MAPLOC_RETURN_IF_ERROR(ValidateObservation(observation));
    if (observation.segment >= 0) {
      MAPLOC_RETURN_IF_ERROR(RequireSegment(database, map, observation.segment));
    }
    MAPLOC_RETURN_IF_ERROR(InsertObservation(insert, id, observation));
  }
  return Status::Ok();
}

Result<std::vector<Observation>> ReadObservations(SqliteDatabase& database, const SessionId& id) {
  SqliteStatement statement(database,
                            "SELECT " + std::string(kObservationColumns) +
                                " FROM observations WHERE session = ?1 ORDER BY sequence");
  return statement.Bind(id).Collect(ObservationAt);
}

Status InsertRow(SqliteDatabase& database, std::int64_t map, const SegmentSessionRow& row,
                 std::int64_t options) {
  // The strategies before and after (3, mixed) are placeholders until KeepStrategies: the row must
  // exist before the strategy after it can be derived.
  SqliteStatement insert(
      database,
      "INSERT INTO segment_sessions (map, segment, session, queries, localized, point_matches, "
      "point_inliers, usable_line_matches, usable_line_inliers, vertical_line_matches, "
      "vertical_line_inliers, median_point_matches, median_usable_line_matches, "
      "median_vertical_line_matches, strategy_before, strategy_after, options, start_unix_ns) "
      "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, 3, 3, ?15, ?16)");
  return insert
      .Bind(map, row.segment, row.session, row.queries, row.localized, row.point_matches,
            row.point_inliers, row.usable_line_matches, row.usable_line_inliers,
            row.vertical_line_matches, row.vertical_line_inliers, row.median_point_matches,
            row.median_usable_line_matches, row.median_vertical_line_matches, options,
            row.session_start_unix_ns)
      .Run();
}

Status KeepStrategies(SqliteDatabase& database, std::int64_t map, const SessionId& id,
                      const SessionSummary::SegmentChange& change) {
  SqliteStatement update(database,
                         "UPDATE segment_sessions SET strategy_before = ?4, strategy_after = ?5 "
                         "WHERE map = ?1 AND segment = ?2 AND session = ?3");
  return update
      .Bind(map, change.segment, id, static_cast<std::int64_t>(change.strategy_before),
            static_cast<std::int64_t>(change.strategy_after))
      .Run();
}

Result<std::vector<TrueRow>> ReadRows(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                      const FoldPosition& after) {
  // A row has a copy of its session's start, because an index cannot span two tables.
  SqliteStatement statement(database,
                            "SELECT " + std::string(kRowColumns) +
                                ", s.end_unix_ns, r.options "
                                "FROM segment_sessions r JOIN sessions s ON s.id = r.session "
                                "WHERE r.map = ?1 AND r.segment = ?2 AND "
                                "(r.start_unix_ns, r.session) > (?3, ?4) AND s.revoked = 0 "
                                "ORDER BY r.start_unix_ns, r.session");
  return statement.Bind(map, id, after.session_start_unix_ns, after.session)
      .Collect([map](const SqliteStatement& row) {
        return TrueRow{RowAt(row), map, row.Int("end_unix_ns"), row.Int("options")};
      });
}

Result<std::vector<SegmentSessionRow>> ReadRowsOfSession(SqliteDatabase& database,
                                                         const SessionId& id) {
  SqliteStatement statement(database,
                            "SELECT " + std::string(kRowColumns) +
                                " FROM segment_sessions r JOIN sessions s ON s.id = r.session "
                                "WHERE r.session = ?1 ORDER BY r.segment");
  return statement.Bind(id).Collect(RowAt);
}

}  // namespace maploc
