#include "mapstore/store/sqlite_decisions.h"

namespace maploc {
namespace {

constexpr std::string_view kDecisionColumns =
    "d.time_unix_ns, d.cause, d.strategy, d.source, d.reason, d.predicted_success, d.sessions, "
    "d.queries, d.localized, d.point_matches, d.point_inliers, d.usable_line_matches, "
    "d.usable_line_inliers, d.vertical_line_matches, d.vertical_line_inliers, "
    "d.typical_point_matches, d.typical_usable_line_matches, d.typical_vertical_line_matches";
constexpr int kDecisionColumnCount = 18;

DecisionRecord DecisionAt(const SqliteStatement& row) {
  DecisionRecord record;
  record.time_unix_ns = row.Int(0);
  record.cause = row.Text(1);
  record.decision = {static_cast<Strategy>(row.Int(2)), static_cast<StrategySource>(row.Int(3)),
                     row.Text(4), row.Real(5)};
  SegmentStatistics& statistics = record.statistics;
  statistics.sessions = row.Int(6);
  statistics.queries = row.Int(7);
  statistics.localized = row.Int(8);
  statistics.point_matches = row.Real(9);
  statistics.point_inliers = row.Real(10);
  statistics.usable_line_matches = row.Real(11);
  statistics.usable_line_inliers = row.Real(12);
  statistics.vertical_line_matches = row.Real(13);
  statistics.vertical_line_inliers = row.Real(14);
  statistics.typical_point_matches = row.Real(15);
  statistics.typical_usable_line_matches = row.Real(16);
  statistics.typical_vertical_line_matches = row.Real(17);
  return record;
}

SelectorOptions OptionsAt(const SqliteStatement& row, int column) {
  SelectorOptions options;
  options.statistics.half_life_sessions = row.Real(column);
  options.statistics.change_discount = row.Real(column + 1);
  options.statistics.independent_matches_per_query = row.Real(column + 2);
  options.min_localized_queries = row.Int(column + 3);
  options.prior_matches = row.Real(column + 4);
  options.prior_inlier_ratio = row.Real(column + 5);
  options.hysteresis = row.Real(column + 6);
  options.cost_1p1l = row.Real(column + 7);
  options.cost_2p = row.Real(column + 8);
  options.cost_mixed = row.Real(column + 9);
  return options;
}

// The row of these options, made where there is none yet: a store sees few of them.
Result<std::int64_t> OptionsRow(SqliteDatabase& database, const SelectorOptions& options) {
  const auto bind = [&options](SqliteStatement& statement) -> SqliteStatement& {
    const StatisticsOptions& statistics = options.statistics;
    return statement.Bind(statistics.half_life_sessions, statistics.change_discount,
                          statistics.independent_matches_per_query, options.min_localized_queries,
                          options.prior_matches, options.prior_inlier_ratio, options.hysteresis,
                          options.cost_1p1l, options.cost_2p, options.cost_mixed);
  };
  SqliteStatement find(
      database,
      "SELECT id FROM selector_options WHERE half_life_sessions = ?1 AND change_discount = ?2 AND "
      "independent_matches_per_query = ?3 AND min_localized_queries = ?4 AND prior_matches = ?5 "
      "AND prior_inlier_ratio = ?6 AND hysteresis = ?7 AND cost_1p1l = ?8 AND cost_2p = ?9 AND "
      "cost_mixed = ?10");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, bind(find).Step());
  if (found) return find.Int(0);
  SqliteStatement insert(database,
                         "INSERT INTO selector_options (half_life_sessions, change_discount, "
                         "independent_matches_per_query, min_localized_queries, prior_matches, "
                         "prior_inlier_ratio, hysteresis, cost_1p1l, cost_2p, cost_mixed) "
                         "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)");
  MAPLOC_RETURN_IF_ERROR(bind(insert).Run());
  return database.LastInsertId();
}

}  // namespace

Result<SegmentState> ReadSegmentState(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                      const SelectorOptions& defaults) {
  SqliteStatement statement(
      database, "SELECT " + std::string(kDecisionColumns) +
                    ", d.pinned, o.half_life_sessions, o.change_discount, "
                    "o.independent_matches_per_query, o.min_localized_queries, o.prior_matches, "
                    "o.prior_inlier_ratio, o.hysteresis, o.cost_1p1l, o.cost_2p, o.cost_mixed "
                    "FROM decisions d JOIN selector_options o ON o.id = d.options "
                    "WHERE d.map = ?1 AND d.segment = ?2 ORDER BY d.id DESC LIMIT 1");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(map, id).Step());
  if (!found) return SegmentState{DeriveSegment({}, std::nullopt, defaults), {}, defaults};
  const DecisionRecord record = DecisionAt(statement);
  SegmentState state;
  state.derived = {record.statistics, record.decision};
  if (!statement.IsNull(kDecisionColumnCount)) {
    state.pinned = static_cast<Strategy>(statement.Int(kDecisionColumnCount));
  }
  state.options = OptionsAt(statement, kDecisionColumnCount + 1);
  return state;
}

Result<std::vector<DecisionRecord>> ReadDecisions(SqliteDatabase& database, std::int64_t map,
                                                  SegmentId id) {
  SqliteStatement statement(database, "SELECT " + std::string(kDecisionColumns) +
                                          " FROM decisions d WHERE d.map = ?1 AND d.segment = ?2 "
                                          "ORDER BY d.id");
  statement.Bind(map, id);
  std::vector<DecisionRecord> records;
  while (true) {
    MAPLOC_ASSIGN_OR_RETURN(const bool row, statement.Step());
    if (!row) return records;
    records.push_back(DecisionAt(statement));
  }
}

Status InsertDecision(SqliteDatabase& database, std::int64_t map, SegmentId id,
                      std::int64_t time_unix_ns, const std::string& cause,
                      const SegmentState& state) {
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t options, OptionsRow(database, state.options));
  SqliteStatement statement(
      database,
      "INSERT INTO decisions (map, segment, time_unix_ns, cause, options, pinned, strategy, "
      "source, reason, predicted_success, sessions, queries, localized, point_matches, "
      "point_inliers, usable_line_matches, usable_line_inliers, vertical_line_matches, "
      "vertical_line_inliers, typical_point_matches, typical_usable_line_matches, "
      "typical_vertical_line_matches) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, "
      "?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, ?21, ?22)");
  std::optional<std::int64_t> pinned;
  if (state.pinned) pinned = static_cast<std::int64_t>(*state.pinned);
  const StrategyDecision& decision = state.derived.decision;
  const SegmentStatistics& sums = state.derived.statistics;
  return statement
      .Bind(map, id, time_unix_ns, cause, options, pinned,
            static_cast<std::int64_t>(decision.strategy),
            static_cast<std::int64_t>(decision.source), decision.reason, decision.predicted_success,
            sums.sessions, sums.queries, sums.localized, sums.point_matches, sums.point_inliers,
            sums.usable_line_matches, sums.usable_line_inliers, sums.vertical_line_matches,
            sums.vertical_line_inliers, sums.typical_point_matches,
            sums.typical_usable_line_matches, sums.typical_vertical_line_matches)
      .Run();
}

}  // namespace maploc
