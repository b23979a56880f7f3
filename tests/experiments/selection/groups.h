// The queries of a result, grouped as the tables ask for them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/experiments/selection/run_selection.h"

namespace maploc::selection {

// Of one session (index into result.sessions), with what was selected when it was left out.
std::vector<ScoredQuery> QueriesOf(const SelectionResult& result, std::size_t session,
                                   std::optional<Scene> scene = std::nullopt);
std::vector<ScoredQuery> QueriesIn(const SelectionResult& result, std::size_t session,
                                   SegmentId segment);
// Of all sessions, each as it was when it was left out.
std::vector<ScoredQuery> WholeOf(const SelectionResult& result,
                                 std::optional<Scene> scene = std::nullopt);

struct NamedGroup {
  std::string name;
  std::vector<ScoredQuery> queries;
};
// Every session, then the whole.
std::vector<NamedGroup> SessionsAndWhole(const SelectionResult& result);

// The methods that were asked for, and the selection.
std::vector<int> ColumnsOf(const SelectionResult& result);
// Those of them that have a second pass.
std::vector<int> LongColumnsOf(const SelectionResult& result);

// The best of 1P1L, 2P and mixed with the product's refinement, by area under the curve.
int BestSingle(const std::vector<ScoredQuery>& queries);

}  // namespace maploc::selection
