// What the sessions but one teach, and how the one left out fares with it. Pure functions over the
// trials.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mapstore/statistics/selector.h"
#include "tests/experiments/selection/trials.h"

namespace maploc::selection {

struct SessionResult {
  std::string name;
  std::vector<QueryResult> queries;
};

// A segment as the sessions but one see it.
struct SegmentChoice {
  SegmentStatistics statistics;
  StrategyDecision decision;
  StrategyPrediction prediction;
};

struct LeftOut {
  std::string name;                             // of the session left out
  std::map<SegmentId, SegmentChoice> segments;  // those that the others visited
  std::vector<int> selected;                    // one a query of that session: index into kMethods
};

// For every session: rows of all others in the order of time, folded and selected as the store
// does. A segment that none of them visited is mixed.
std::vector<LeftOut> LeaveEachOut(const std::vector<SessionResult>& sessions,
                                  const SelectorOptions& selector);

// The decision where the query is; mixed where no other session taught any.
StrategyDecision DecisionFor(const LeftOut& left_out, SegmentId segment);

// What all sessions together teach.
std::map<SegmentId, SegmentChoice> ChooseForAll(const std::vector<SessionResult>& sessions,
                                                const SelectorOptions& selector);

// kMethods, and the selection behind them.
inline constexpr int kSelection = kMethodCount;
inline constexpr int kColumnCount = kMethodCount + 1;
std::string_view ColumnName(int column);

// The result of the first pass behind a column.
const MethodResult& ResultOf(const QueryResult& query, int column, int selected);
// Its search in the second pass. The selection's is not that of the method that was selected: it
// gives up.
const LongSearch& LongSearchOf(const QueryResult& query, int column);

// A query with what was selected for it.
struct ScoredQuery {
  const QueryResult* query = nullptr;
  int selected = 0;
};

struct Score {
  double auc = 0.0;
  std::array<double, 4> recall{};  // at kRecallThresholds
  double mean_long_iterations = 0.0;
  double mean_long_ms = 0.0;
  double long_recall = 0.0;  // of the long search, at the first of kRecallThresholds
};

Score ScoreOf(const std::vector<ScoredQuery>& queries, int column);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

// 95% of bootstrap samples (queries drawn with replacement) of mean credit of the selection, less
// that of `column` where one is given (kSelection: not less anything).
Interval BootstrapSelection(const std::vector<ScoredQuery>& queries, int less_column,
                            std::uint64_t seed);

}  // namespace maploc::selection
