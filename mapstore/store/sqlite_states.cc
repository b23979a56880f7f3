#include "mapstore/store/sqlite_states.h"

#include <utility>
#include <vector>

#include "mapstore/store/sqlite_folds.h"
#include "mapstore/store/sqlite_inheritance.h"

namespace maploc {
namespace {

// In the order in which WriteState binds them.
constexpr std::string_view kStateColumns =
    "map, segment, options, pinned, strategy, source, reason, predicted_success, sessions, "
    "queries, "
    "localized, point_matches, point_inliers, usable_line_matches, usable_line_inliers, "
    "vertical_line_matches, vertical_line_inliers, typical_point_matches, "
    "typical_usable_line_matches, typical_vertical_line_matches, weighted_queries, "
    "weighted_localized, independent_points, independent_usable_lines, independent_vertical_lines, "
    "second_choice, third_choice, changed";
// In the order in which OptionsRow binds them.
constexpr std::string_view kOptionColumns =
    "half_life_sessions, change_discount, independent_matches_per_query, min_localized_queries, "
    "prior_matches, prior_inlier_ratio, hysteresis, cost_1p1l, cost_2p, cost_mixed, "
    "independent_queries_per_session, criterion, max_iterations, two_points_good, two_points_bad, "
    "point_and_line_good, point_and_line_bad, point_and_verticals_good, point_and_verticals_bad";

Result<std::optional<std::int64_t>> ReadMeta(SqliteDatabase& database, std::string_view name) {
  SqliteStatement meta(database, "SELECT value FROM meta WHERE name = ?1");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, meta.Bind(name).Step());
  return found ? std::optional(meta.Int("value")) : std::nullopt;
}

std::optional<Strategy> PinAt(const SqliteStatement& row, ColumnName column) {
  if (row.IsNull(column)) return std::nullopt;
  return row.Enum<Strategy>(column);
}

std::optional<std::int64_t> NumberOf(const std::optional<Strategy>& pinned) {
  if (!pinned) return std::nullopt;
  return static_cast<std::int64_t>(*pinned);
}

SegmentState StateAt(const SqliteStatement& row) {
  SegmentState state;
  state.pinned = PinAt(row, "pinned");
  state.derived.decision = {row.Enum<Strategy>("strategy"),
                            row.Enum<StrategySource>("source"),
                            row.Text("reason"),
                            row.Real("predicted_success"),
                            {row.Enum<Strategy>("strategy"), row.Enum<Strategy>("second_choice"),
                             row.Enum<Strategy>("third_choice")}};
  SegmentStatistics& statistics = state.derived.statistics;
  statistics.sessions = row.Int("sessions");
  statistics.queries = row.Int("queries");
  statistics.localized = row.Int("localized");
  statistics.point_matches = row.Real("point_matches");
  statistics.point_inliers = row.Real("point_inliers");
  statistics.usable_line_matches = row.Real("usable_line_matches");
  statistics.usable_line_inliers = row.Real("usable_line_inliers");
  statistics.vertical_line_matches = row.Real("vertical_line_matches");
  statistics.vertical_line_inliers = row.Real("vertical_line_inliers");
  statistics.typical_point_matches = row.Real("typical_point_matches");
  statistics.typical_usable_line_matches = row.Real("typical_usable_line_matches");
  statistics.typical_vertical_line_matches = row.Real("typical_vertical_line_matches");
  statistics.weighted_queries = row.Real("weighted_queries");
  statistics.weighted_localized = row.Real("weighted_localized");
  statistics.independent_points = row.Real("independent_points");
  statistics.independent_usable_lines = row.Real("independent_usable_lines");
  statistics.independent_vertical_lines = row.Real("independent_vertical_lines");
  return state;
}

SelectorOptions OptionsAt(const SqliteStatement& row) {
  SelectorOptions options;
  options.statistics.half_life_sessions = row.Real("half_life_sessions");
  options.statistics.change_discount = row.Real("change_discount");
  options.statistics.independent_matches_per_query = row.Real("independent_matches_per_query");
  options.min_localized_queries = row.Int("min_localized_queries");
  options.prior_matches = row.Real("prior_matches");
  options.prior_inlier_ratio = row.Real("prior_inlier_ratio");
  options.hysteresis = row.Real("hysteresis");
  options.cost_1p1l = row.Real("cost_1p1l");
  options.cost_2p = row.Real("cost_2p");
  options.cost_mixed = row.Real("cost_mixed");
  options.statistics.independent_queries_per_session = row.Real("independent_queries_per_session");
  options.criterion = row.Enum<StrategyCriterion>("criterion");
  options.max_iterations = row.Int("max_iterations");
  options.yields.two_points = {row.Real("two_points_good"), row.Real("two_points_bad")};
  options.yields.point_and_line = {row.Real("point_and_line_good"), row.Real("point_and_line_bad")};
  options.yields.point_and_verticals = {row.Real("point_and_verticals_good"),
                                        row.Real("point_and_verticals_bad")};
  return options;
}

Result<SelectorOptions> ReadOptions(SqliteDatabase& database, std::int64_t id) {
  SqliteStatement statement(
      database, "SELECT " + std::string(kOptionColumns) + " FROM selector_options WHERE id = ?1");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(id).Step());
  if (!found) return Internal("selector options " + std::to_string(id) + " are missing");
  return OptionsAt(statement);
}

// `options` becomes the row of the last pin's options.
Status ReadPins(SqliteDatabase& database, std::int64_t map, SegmentId id, std::vector<Pin>& pins,
                std::optional<std::int64_t>& options) {
  SqliteStatement statement(database,
                            "SELECT time_unix_ns, strategy, options FROM pins "
                            "WHERE map = ?1 AND segment = ?2 ORDER BY id");
  statement.Bind(map, id);
  while (true) {
    MAPLOC_ASSIGN_OR_RETURN(const bool row, statement.Step());
    if (!row) return Status::Ok();
    pins.push_back({statement.Int("time_unix_ns"), PinAt(statement, "strategy")});
    options = statement.Int("options");
  }
}

// The change counter's value at this transaction's end.
Result<std::int64_t> NextChange(SqliteDatabase& database) {
  MAPLOC_ASSIGN_OR_RETURN(const auto counter, ReadMeta(database, "change_counter"));
  return counter.value_or(0) + 1;
}

Status WriteState(SqliteDatabase& database, std::int64_t map, SegmentId id,
                  const SegmentState& state) {
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t options, OptionsRow(database, state.options));
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t change, NextChange(database));
  const std::string columns(kStateColumns);
  SqliteStatement statement(database, "INSERT OR REPLACE INTO segment_states (" + columns +
                                          ") VALUES " + ParametersFor(columns));
  const StrategyDecision& decision = state.derived.decision;
  const SegmentStatistics& sums = state.derived.statistics;
  return statement
      .Bind(map, id, options, NumberOf(state.pinned), static_cast<std::int64_t>(decision.strategy),
            static_cast<std::int64_t>(decision.source), decision.reason, decision.predicted_success,
            sums.sessions, sums.queries, sums.localized, sums.point_matches, sums.point_inliers,
            sums.usable_line_matches, sums.usable_line_inliers, sums.vertical_line_matches,
            sums.vertical_line_inliers, sums.typical_point_matches,
            sums.typical_usable_line_matches, sums.typical_vertical_line_matches,
            sums.weighted_queries, sums.weighted_localized, sums.independent_points,
            sums.independent_usable_lines, sums.independent_vertical_lines,
            static_cast<std::int64_t>(decision.ranking[1]),
            static_cast<std::int64_t>(decision.ranking[2]), change)
      .Run();
}

// A deleted row cannot carry `changed`. So this number tells ReadChanged that any segment may have
// changed.
Status DeleteState(SqliteDatabase& database, std::int64_t map, SegmentId id) {
  SqliteStatement remove(database, "DELETE FROM segment_states WHERE map = ?1 AND segment = ?2");
  MAPLOC_RETURN_IF_ERROR(remove.Bind(map, id).Run());
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t change, NextChange(database));
  SqliteStatement keep(database, "INSERT OR REPLACE INTO meta VALUES ('states_deleted', ?1)");
  return keep.Bind(change).Run();
}

// Adds `rows` to the fold of `last`, and keeps checkpoints.
Status FoldOn(SqliteDatabase& database, std::int64_t map, SegmentId id,
              const std::optional<FoldCheckpoint>& last, std::span<const TrueRow> rows,
              SelectorFold& fold) {
  if (rows.empty()) return Status::Ok();
  // This checkpoint was stored only because its row was the last one, which another is now.
  if (last && !IsKept(last->state)) {
    MAPLOC_RETURN_IF_ERROR(DeleteCheckpoint(database, map, id, last->position));
  }
  for (const TrueRow& row : rows) {
    fold.Add(row.row);
    if (&row != &rows.back() && !IsKept(fold.state())) continue;
    MAPLOC_RETURN_IF_ERROR(InsertCheckpoint(
        database, map, id, {row.position(), fold.state(), rows.back().options, row.options}));
  }
  return Status::Ok();
}

Result<std::vector<std::pair<std::int64_t, SegmentId>>> SegmentsWithTruth(
    SqliteDatabase& database) {
  // An heir may have shares but no row of its own yet.
  SqliteStatement statement(database,
                            "SELECT map, segment FROM segment_sessions UNION "
                            "SELECT map, segment FROM pins UNION "
                            "SELECT map, segment FROM inheritance ORDER BY 1, 2");
  return statement.Collect(
      [](const SqliteStatement& row) { return std::pair(row.Int("map"), row.Int32("segment")); });
}

}  // namespace

Result<SegmentTruth> ReadTruth(SqliteDatabase& database, std::int64_t map, SegmentId id,
                               const SelectorOptions& defaults) {
  SegmentTruth truth;
  truth.options = defaults;
  std::optional<std::int64_t> options;
  MAPLOC_RETURN_IF_ERROR(ReadPins(database, map, id, truth.pins, options));
  MAPLOC_ASSIGN_OR_RETURN(auto rows, ReadTrueRows(database, map, id, BeforeAllRows()));
  for (TrueRow& row : rows) {
    truth.rows.push_back(std::move(row.row));
    truth.ends_unix_ns.push_back(row.end_unix_ns);
    // The newest row's options prevail over those of the last pin (FORMAT.md).
    options = row.options;
  }
  if (options) {
    MAPLOC_ASSIGN_OR_RETURN(truth.options, ReadOptions(database, *options));
  }
  return truth;
}

Result<SegmentState> ReadSegmentState(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                      const SelectorOptions& defaults) {
  SqliteStatement statement(
      database, "SELECT " + std::string(kStateColumns) + ", " + std::string(kOptionColumns) +
                    " FROM segment_states d JOIN selector_options o ON o.id = "
                    "d.options WHERE d.map = ?1 AND d.segment = ?2");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(map, id).Step());
  if (!found) {
    SegmentTruth nothing;
    nothing.options = defaults;
    return DeriveState(nothing);
  }
  SegmentState state = StateAt(statement);
  state.options = OptionsAt(statement);
  return state;
}

Result<std::int64_t> OptionsRow(SqliteDatabase& database, const SelectorOptions& options) {
  const auto bind = [&options](SqliteStatement& statement) -> SqliteStatement& {
    const StatisticsOptions& statistics = options.statistics;
    return statement.Bind(
        statistics.half_life_sessions, statistics.change_discount,
        statistics.independent_matches_per_query, options.min_localized_queries,
        options.prior_matches, options.prior_inlier_ratio, options.hysteresis, options.cost_1p1l,
        options.cost_2p, options.cost_mixed, statistics.independent_queries_per_session,
        static_cast<std::int64_t>(options.criterion), options.max_iterations,
        options.yields.two_points.good, options.yields.two_points.bad,
        options.yields.point_and_line.good, options.yields.point_and_line.bad,
        options.yields.point_and_verticals.good, options.yields.point_and_verticals.bad);
  };
  const std::string columns(kOptionColumns);
  SqliteStatement find(database, "SELECT id FROM selector_options WHERE (" + columns +
                                     ") = " + ParametersFor(columns));
  MAPLOC_ASSIGN_OR_RETURN(const bool found, bind(find).Step());
  if (found) return find.Int("id");
  SqliteStatement insert(
      database, "INSERT INTO selector_options (" + columns + ") VALUES " + ParametersFor(columns));
  MAPLOC_RETURN_IF_ERROR(bind(insert).Run());
  return database.LastInsertId();
}

Status InsertPin(SqliteDatabase& database, std::int64_t map, SegmentId id, const Pin& pin,
                 const SelectorOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t options_row, OptionsRow(database, options));
  SqliteStatement insert(database,
                         "INSERT INTO pins (map, segment, time_unix_ns, strategy, options) VALUES "
                         "(?1, ?2, ?3, ?4, ?5)");
  return insert.Bind(map, id, pin.time_unix_ns, NumberOf(pin.strategy), options_row).Run();
}

Result<SegmentState> DeriveAnew(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                const SelectorOptions& defaults, const FoldPosition& changed) {
  MAPLOC_RETURN_IF_ERROR(DeleteCheckpointsFrom(database, map, id, changed));
  MAPLOC_ASSIGN_OR_RETURN(const auto last, ReadLastCheckpoint(database, map, id));
  // Where the last one is damaged, none before it is needed: all rows are folded.
  if (!last) MAPLOC_RETURN_IF_ERROR(DeleteCheckpointsFrom(database, map, id, BeforeAllRows()));
  MAPLOC_ASSIGN_OR_RETURN(const auto rows,
                          ReadTrueRows(database, map, id, last ? last->position : BeforeAllRows()));
  std::vector<Pin> pins;
  std::optional<std::int64_t> options_row;
  MAPLOC_RETURN_IF_ERROR(ReadPins(database, map, id, pins, options_row));
  if (last) options_row = last->row_options;
  if (!rows.empty()) options_row = rows.back().options;
  // Sums that were folded with other options cannot be continued. The call below finds no
  // checkpoint, so it does not come here again.
  if (last && last->options != *options_row) {
    return DeriveAnew(database, map, id, defaults, BeforeAllRows());
  }
  SelectorOptions options = defaults;
  if (options_row) {
    MAPLOC_ASSIGN_OR_RETURN(options, ReadOptions(database, *options_row));
  }
  SelectorFold fold(options, last ? last->state : SelectorState{});
  MAPLOC_RETURN_IF_ERROR(FoldOn(database, map, id, last, rows, fold));
  const SegmentState state =
      StateOf(fold, options, pins.empty() ? std::nullopt : pins.back().strategy);
  // Without rows and pins there is no state to store: readers derive it with their own options.
  MAPLOC_RETURN_IF_ERROR(options_row ? WriteState(database, map, id, state)
                                     : DeleteState(database, map, id));
  return state;
}

Result<std::vector<SegmentId>> ReadChanged(SqliteDatabase& database, std::int64_t map,
                                           std::int64_t since) {
  MAPLOC_ASSIGN_OR_RETURN(const auto deleted, ReadMeta(database, "states_deleted"));
  const bool all = deleted.value_or(0) > since;
  SqliteStatement ids(database, all ? "SELECT segment FROM segments WHERE map = ?1 ORDER BY segment"
                                    : "SELECT segment FROM segment_states WHERE map = ?1 AND "
                                      "changed > ?2 ORDER BY segment");
  all ? ids.Bind(map) : ids.Bind(map, since);
  return ids.Collect([](const SqliteStatement& row) { return row.Int32("segment"); });
}

Result<bool> IsStale(SqliteDatabase& database) {
  MAPLOC_ASSIGN_OR_RETURN(const auto kept, ReadMeta(database, "derivation_fingerprint"));
  return kept != DerivationFingerprint();
}

Status DeriveAllAnew(SqliteDatabase& database) {
  MAPLOC_RETURN_IF_ERROR(database.Execute("DELETE FROM segment_folds"));
  // The default options below matter only to segments without rows and pins, whose state is not
  // stored.
  MAPLOC_ASSIGN_OR_RETURN(const auto segments, SegmentsWithTruth(database));
  for (const auto& [map, id] : segments) {
    MAPLOC_RETURN_IF_ERROR(
        DeriveAnew(database, map, id, SelectorOptions{}, BeforeAllRows()).status());
  }
  SqliteStatement keep(database,
                       "INSERT OR REPLACE INTO meta VALUES ('derivation_fingerprint', ?1)");
  MAPLOC_RETURN_IF_ERROR(keep.Bind(DerivationFingerprint()).Run());
  return database.Execute("UPDATE meta SET value = value + 1 WHERE name = 'change_counter'");
}

}  // namespace maploc
