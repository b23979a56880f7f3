// A query's trials: matched once, then tried with every method; and what the product would have
// recorded of it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/robot/metrics.h"
#include "mapstore/model/session.h"
#include "tests/experiments/selection/methods.h"
#include "tests/experiments/selection/selection_set.h"

namespace maploc::selection {

struct TrialOptions {
  int trials = 5;  // searches a query and method, each with its own seed
  std::uint64_t seed = 1;
  SearchLimits short_search{.max_iterations = 100, .confidence = 0.999, .fall_back = false};
  // With the product's fallback: a strategy that cannot be drawn must not look fast.
  SearchLimits long_search{.max_iterations = 100'000, .confidence = 0.999, .fall_back = true};
};

struct MethodResult {
  std::vector<std::optional<PoseError>> errors;  // one a trial of the short search
  double credit = 0.0;                           // AreaUnderCurve of these
  int long_iterations = 0;                       // of the one long search
  double long_ms = 0.0;
};

struct QueryResult {
  SegmentId segment = -1;  // the best ranked, whose matches all methods had; -1: none
  std::optional<Scene> scene;
  std::array<MethodResult, kMethodCount> methods;  // in the order of kMethods
  // As the server records a query that it answers with "mixed" and all its means.
  Observation observation;
};

// One a query of the session. Deterministic, times apart.
Result<std::vector<QueryResult>> RunTrials(const SelectionSet& set, const SetSession& session,
                                           const TrialOptions& options, const ProgressFn& progress);

}  // namespace maploc::selection
