// Which strategy a segment should use (the paper's section IV; README.md, "Selection").
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mapstore/model/session.h"
#include "mapstore/statistics/prediction.h"
#include "mapstore/statistics/selector_options.h"
#include "mapstore/statistics/statistics.h"

namespace maploc {

// A change of the strategy in force, by a session.
struct StrategySwitch {
  SessionId session;
  std::int64_t session_start_unix_ns = 0;
  Strategy before = Strategy::kMixed;
  StrategyDecision after;
};

// All that the fold below has to remember of the rows so far.
struct SelectorState {
  StatisticsSums sums;
  Strategy previous = Strategy::kMixed;  // in force before the last row
  Strategy current = Strategy::kMixed;
  bool operator==(const SelectorState&) const = default;
};

// Rows one after the other, oldest first; the decision in force after each. Hysteresis compares
// with the one before, so a decision depends on the rows' order, which is theirs: (start, session).
class SelectorFold {
 public:
  // `state`: after the rows before, folded with the same options. Goes on from there to the bit.
  explicit SelectorFold(const SelectorOptions& options, const SelectorState& state = {});

  // REQUIRES: rows come in the order (session_start_unix_ns, session).
  void Add(const SegmentSessionRow& row);
  SelectorState state() const { return {statistics_.sums(), previous_, current_}; }
  Strategy current() const { return current_; }
  bool HasEvidence() const;
  const StatisticsFold& statistics() const { return statistics_; }
  // Of the rows so far, whether or not they are evidence enough to be followed.
  const StrategyPrediction& prediction() const { return prediction_; }
  StrategyDecision Decision() const;

 private:
  SelectorOptions options_;
  StatisticsFold statistics_;
  StrategyPrediction prediction_;
  Strategy previous_;
  Strategy current_;
};

// `ranking` with `first` moved to its front. REQUIRES: it is in there.
std::array<Strategy, 3> RankAfter(Strategy first, std::array<Strategy, 3> ranking);

// The decision after all rows, replayed from the first. Pure: the same rows give the same bits.
// REQUIRES: rows in the order (session_start_unix_ns, session).
StrategyDecision SelectStrategy(std::span<const SegmentSessionRow> rows,
                                const SelectorOptions& options = {});

// Every change of strategy on the way, oldest first. REQUIRES: as above.
std::vector<StrategySwitch> ListSwitches(std::span<const SegmentSessionRow> rows,
                                         const SelectorOptions& options = {});

}  // namespace maploc
