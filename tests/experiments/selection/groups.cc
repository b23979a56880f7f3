#include "tests/experiments/selection/groups.h"

#include <algorithm>

namespace maploc::selection {
namespace {

bool HasSecondPass(int column) {
  return column == kSelection || column == kP3pMethod ||
         std::ranges::any_of(kStrategies, [&](Strategy s) { return AutoMethodOf(s) == column; });
}

}  // namespace

std::vector<ScoredQuery> QueriesOf(const SelectionResult& result, std::size_t session,
                                   std::optional<Scene> scene) {
  std::vector<ScoredQuery> queries;
  const std::vector<QueryResult>& all = result.sessions[session].queries;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (scene && all[i].scene != scene) continue;
    queries.push_back({&all[i], result.left_out[session].selected[i]});
  }
  return queries;
}

std::vector<ScoredQuery> QueriesIn(const SelectionResult& result, std::size_t session,
                                   SegmentId segment) {
  std::vector<ScoredQuery> queries = QueriesOf(result, session);
  std::erase_if(queries, [&](const ScoredQuery& q) { return q.query->segment != segment; });
  return queries;
}

std::vector<ScoredQuery> WholeOf(const SelectionResult& result, std::optional<Scene> scene) {
  std::vector<ScoredQuery> whole;
  for (std::size_t i = 0; i < result.sessions.size(); ++i) {
    const std::vector<ScoredQuery> own = QueriesOf(result, i, scene);
    whole.insert(whole.end(), own.begin(), own.end());
  }
  return whole;
}

std::vector<NamedGroup> SessionsAndWhole(const SelectionResult& result) {
  std::vector<NamedGroup> groups;
  for (std::size_t i = 0; i < result.sessions.size(); ++i) {
    groups.push_back({result.sessions[i].name, QueriesOf(result, i)});
  }
  groups.push_back({"whole", WholeOf(result)});
  return groups;
}

std::vector<int> ColumnsOf(const SelectionResult& result) {
  std::vector<int> columns;
  for (int column = 0; column < kColumnCount; ++column) {
    if (column == kSelection ||
        std::ranges::find(result.flags.methods, ColumnName(column)) != result.flags.methods.end()) {
      columns.push_back(column);
    }
  }
  return columns;
}

std::vector<int> LongColumnsOf(const SelectionResult& result) {
  std::vector<int> columns = ColumnsOf(result);
  std::erase_if(columns, [](int column) { return !HasSecondPass(column); });
  return columns;
}

int BestSingle(const std::vector<ScoredQuery>& queries) {
  int best = AutoMethodOf(kStrategies.front());
  for (const Strategy strategy : kStrategies) {
    const int column = AutoMethodOf(strategy);
    if (ScoreOf(queries, column).auc > ScoreOf(queries, best).auc) best = column;
  }
  return best;
}

}  // namespace maploc::selection
