#include "mapstore/store/sqlite_decisions.h"

namespace maploc {
namespace {

constexpr std::string_view kDecisionColumns =
    "d.time_unix_ns, d.cause, d.strategy, d.source, d.reason, d.predicted_success, d.sessions, "
    "d.queries, d.localized, d.point_matches, d.point_inliers, d.usable_line_matches, "
    "d.usable_line_inliers, d.vertical_line_matches, d.vertical_line_inliers, "
    "d.typical_point_matches, d.typical_usable_line_matches, d.typical_vertical_line_matches, "
    "d.weighted_queries, d.weighted_localized, d.independent_points, d.independent_usable_lines, "
    "d.independent_vertical_lines, d.second_choice, d.third_choice";
constexpr int kDecisionColumnCount = 25;

// After those of version 1: half_life_sessions to cost_mixed.
constexpr std::string_view kOptionsColumns =
    "half_life_sessions, change_discount, independent_matches_per_query, min_localized_queries, "
    "prior_matches, prior_inlier_ratio, hysteresis, cost_1p1l, cost_2p, cost_mixed, "
    "independent_queries_per_session, criterion, max_iterations, two_points_good, two_points_bad, "
    "point_and_line_good, point_and_line_bad, point_and_verticals_good, point_and_verticals_bad";

DecisionRecord DecisionAt(const SqliteStatement& row) {
  DecisionRecord record;
  record.time_unix_ns = row.Int(0);
  record.cause = row.Text(1);
  record.decision = {static_cast<Strategy>(row.Int(2)),
                     static_cast<StrategySource>(row.Int(3)),
                     row.Text(4),
                     row.Real(5),
                     {static_cast<Strategy>(row.Int(2)), static_cast<Strategy>(row.Int(23)),
                      static_cast<Strategy>(row.Int(24))}};
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
  statistics.weighted_queries = row.Real(18);
  statistics.weighted_localized = row.Real(19);
  statistics.independent_points = row.Real(20);
  statistics.independent_usable_lines = row.Real(21);
  statistics.independent_vertical_lines = row.Real(22);
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
  options.statistics.independent_queries_per_session = row.Real(column + 10);
  options.criterion = static_cast<StrategyCriterion>(row.Int(column + 11));
  options.max_iterations = row.Int(column + 12);
  options.two_points = {row.Real(column + 13), row.Real(column + 14)};
  options.point_and_line = {row.Real(column + 15), row.Real(column + 16)};
  options.point_and_verticals = {row.Real(column + 17), row.Real(column + 18)};
  return options;
}

// The row of these options, made where there is none yet: a store sees few of them.
Result<std::int64_t> OptionsRow(SqliteDatabase& database, const SelectorOptions& options) {
  const auto bind = [&options](SqliteStatement& statement) -> SqliteStatement& {
    const StatisticsOptions& statistics = options.statistics;
    return statement.Bind(statistics.half_life_sessions, statistics.change_discount,
                          statistics.independent_matches_per_query, options.min_localized_queries,
                          options.prior_matches, options.prior_inlier_ratio, options.hysteresis,
                          options.cost_1p1l, options.cost_2p, options.cost_mixed,
                          statistics.independent_queries_per_session,
                          static_cast<std::int64_t>(options.criterion), options.max_iterations,
                          options.two_points.good, options.two_points.bad,
                          options.point_and_line.good, options.point_and_line.bad,
                          options.point_and_verticals.good, options.point_and_verticals.bad);
  };
  constexpr std::string_view kParameters =
      "(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19)";
  const std::string columns(kOptionsColumns);
  SqliteStatement find(database, "SELECT id FROM selector_options WHERE (" + columns +
                                     ") = " + std::string(kParameters));
  MAPLOC_ASSIGN_OR_RETURN(const bool found, bind(find).Step());
  if (found) return find.Int(0);
  SqliteStatement insert(database, "INSERT INTO selector_options (" + columns + ") VALUES " +
                                       std::string(kParameters));
  MAPLOC_RETURN_IF_ERROR(bind(insert).Run());
  return database.LastInsertId();
}

}  // namespace

Result<SegmentState> ReadSegmentState(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                      const SelectorOptions& defaults) {
  SqliteStatement statement(database,
                            "SELECT " + std::string(kDecisionColumns) + ", d.pinned, " +
                                std::string(kOptionsColumns) +
                                " FROM decisions d JOIN selector_options o ON o.id = d.options "
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
      "typical_vertical_line_matches, weighted_queries, weighted_localized, independent_points, "
      "independent_usable_lines, independent_vertical_lines, second_choice, third_choice) VALUES "
      "(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, "
      "?21, ?22, ?23, ?24, ?25, ?26, ?27, ?28, ?29)");
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
            sums.typical_usable_line_matches, sums.typical_vertical_line_matches,
            sums.weighted_queries, sums.weighted_localized, sums.independent_points,
            sums.independent_usable_lines, sums.independent_vertical_lines,
            static_cast<std::int64_t>(decision.ranking[1]),
            static_cast<std::int64_t>(decision.ranking[2]))
      .Run();
}

}  // namespace maploc
