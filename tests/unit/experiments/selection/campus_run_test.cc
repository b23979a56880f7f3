// The whole experiment on a handful of queries: from the mapping drive to the scores.
#include <gtest/gtest.h>

#include "tests/experiments/selection/groups.h"
#include "tests/experiments/selection/run_selection.h"

namespace maploc::selection {
namespace {

SelectionFlags Handful() {
  SelectionFlags flags;
  flags.queries = 8;
  flags.trials.trials = 1;
  flags.selector.min_localized_queries = 2;  // that so few queries select anything
  return flags;
}

TEST(CampusRunTest, ScoresAreSharesAndTheSelectionIsThePerSegmentChoice) {
  const Result<SelectionResult> result = RunSelection(Handful(), nullptr);
  ASSERT_TRUE(result.ok()) << result.status().ToString();
  ASSERT_GE(result->sessions.size(), 5u);
  for (std::size_t session = 0; session < result->sessions.size(); ++session) {
    const LeftOut& left_out = result->left_out[session];
    std::vector<std::optional<PoseError>> chosen;
    for (const QueryResult& query : result->sessions[session].queries) {
      const auto found = left_out.segments.find(query.segment);
      const Strategy strategy =
          found == left_out.segments.end() ? Strategy::kMixed : found->second.decision.strategy;
      const auto& errors = query.methods[AutoMethodOf(strategy)].errors;
      chosen.insert(chosen.end(), errors.begin(), errors.end());
    }
    const std::vector<ScoredQuery> queries = QueriesOf(*result, session);
    ASSERT_EQ(queries.size(), 8u);
    EXPECT_EQ(ScoreOf(queries, kSelection).auc, AreaUnderCurve(chosen));
    for (int column = 0; column < kColumnCount; ++column) {
      EXPECT_GE(ScoreOf(queries, column).auc, 0.0);
      EXPECT_LE(ScoreOf(queries, column).auc, 1.0);
    }
  }
  // Days after the mapping drive 100 iterations find most poses: the pieces fit together.
  EXPECT_GT(ScoreOf(QueriesOf(*result, 0), AutoMethodOf(Strategy::kMixed)).auc, 0.5);
}

TEST(CampusRunTest, TheSameSeedGivesTheSameResult) {
  SelectionFlags flags = Handful();
  flags.queries = 2;
  const Result<SelectionResult> once = RunSelection(flags, nullptr);
  const Result<SelectionResult> again = RunSelection(flags, nullptr);
  ASSERT_TRUE(once.ok() && again.ok());
  for (int column = 0; column < kColumnCount; ++column) {
    const Score a = ScoreOf(WholeOf(*once), column);
    const Score b = ScoreOf(WholeOf(*again), column);
    EXPECT_EQ(a.auc, b.auc) << ColumnName(column);
    EXPECT_EQ(a.mean_long_iterations, b.mean_long_iterations) << ColumnName(column);
  }
}

}  // namespace
}  // namespace maploc::selection
