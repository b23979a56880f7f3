#include "tests/experiments/selection/leave_one_out.h"

#include <algorithm>

#include "mapstore/base/random.h"
#include "mapstore/statistics/statistics.h"

namespace maploc::selection {
namespace {

constexpr int kBootstraps = 1000;

using Rows = std::map<SegmentId, std::vector<SegmentSessionRow>>;

std::vector<SegmentSessionRow> RowsOf(const SessionResult& result, int place) {
  Session session;
  session.id = result.name;
  session.start_unix_ns = place + 1;
  std::vector<Observation> observations;
  for (const QueryResult& query : result.queries) observations.push_back(query.observation);
  return FoldObservations(session, observations);
}

std::map<SegmentId, SegmentChoice> Choose(const Rows& rows, const SelectorOptions& selector) {
  std::map<SegmentId, SegmentChoice> choices;
  for (const auto& [segment, own] : rows) {
    SegmentChoice& choice = choices[segment];
    choice.statistics = Aggregate(own, selector.statistics);
    choice.decision = SelectStrategy(own, selector);
    choice.prediction = PredictStrategies(choice.statistics, selector);
  }
  return choices;
}

std::vector<std::vector<SegmentSessionRow>> AllRows(const std::vector<SessionResult>& sessions) {
  std::vector<std::vector<SegmentSessionRow>> rows;
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    rows.push_back(RowsOf(sessions[i], static_cast<int>(i)));
  }
  return rows;
}

// `out`: index of the session that is left out; -1: none.
Rows RowsWithout(const std::vector<std::vector<SegmentSessionRow>>& all, int out) {
  Rows rows;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (static_cast<int>(i) == out) continue;
    for (const SegmentSessionRow& row : all[i]) rows[row.segment].push_back(row);
  }
  return rows;
}

}  // namespace

std::vector<LeftOut> LeaveEachOut(const std::vector<SessionResult>& sessions,
                                  const SelectorOptions& selector) {
  const std::vector<std::vector<SegmentSessionRow>> rows = AllRows(sessions);
  std::vector<LeftOut> all;
  for (std::size_t out = 0; out < sessions.size(); ++out) {
    const Rows others = RowsWithout(rows, static_cast<int>(out));
    LeftOut left_out{sessions[out].name, Choose(others, selector), {}};
    for (const QueryResult& query : sessions[out].queries) {
      left_out.selected.push_back(AutoMethodOf(DecisionFor(left_out, query.segment).strategy));
    }
    all.push_back(std::move(left_out));
  }
  return all;
}

StrategyDecision DecisionFor(const LeftOut& left_out, SegmentId segment) {
  const auto found = left_out.segments.find(segment);
  return found == left_out.segments.end() ? StrategyDecision() : found->second.decision;
}

std::map<SegmentId, SegmentChoice> ChooseForAll(const std::vector<SessionResult>& sessions,
                                                const SelectorOptions& selector) {
  return Choose(RowsWithout(AllRows(sessions), -1), selector);
}

std::string_view ColumnName(int column) {
  return column == kSelection ? "selection" : kMethods[column];
}

const MethodResult& ResultOf(const QueryResult& query, int column, int selected) {
  return query.methods[column == kSelection ? selected : column];
}

const LongSearch& LongSearchOf(const QueryResult& query, int column) {
  return column == kSelection ? query.selection_to_the_end : query.methods[column].to_the_end;
}

Score ScoreOf(const std::vector<ScoredQuery>& queries, int column) {
  Score score;
  std::vector<std::optional<PoseError>> errors, long_errors;
  for (const auto& [query, selected] : queries) {
    const MethodResult& result = ResultOf(*query, column, selected);
    errors.insert(errors.end(), result.errors.begin(), result.errors.end());
    const LongSearch& search = LongSearchOf(*query, column);
    long_errors.push_back(search.error);
    score.mean_long_iterations += static_cast<double>(search.iterations);
    score.mean_long_ms += search.ms;
  }
  const Metrics metrics = Summarize(errors);
  score.auc = metrics.auc;
  score.recall = metrics.recall;
  score.long_recall = Summarize(long_errors).recall.front();
  const double count = std::max<double>(1.0, static_cast<double>(queries.size()));
  score.mean_long_iterations /= count;
  score.mean_long_ms /= count;
  return score;
}

Interval BootstrapSelection(const std::vector<ScoredQuery>& queries, int less_column,
                            std::uint64_t seed) {
  if (queries.empty()) return {};
  std::vector<double> credits;
  for (const auto& [query, selected] : queries) {
    const double own = query->methods[selected].credit;
    credits.push_back(less_column == kSelection ? own : own - query->methods[less_column].credit);
  }
  Random random(seed);
  const auto count = static_cast<std::uint32_t>(credits.size());
  std::vector<double> means;
  for (int i = 0; i < kBootstraps; ++i) {
    double sum = 0.0;
    for (std::uint32_t k = 0; k < count; ++k) sum += credits[random.Below(count)];
    means.push_back(sum / count);
  }
  return {*Quantile(means, 0.025), *Quantile(means, 0.975)};
}

}  // namespace maploc::selection
