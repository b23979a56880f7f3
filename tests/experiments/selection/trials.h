// A query's trials: matched once, then tried with every method (the first pass); and what the
// product would have recorded of it.
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

// The one long search: second_pass.h.
struct LongSearch {
  std::int64_t iterations = 0;
  double ms = 0.0;
  std::optional<PoseError> error;
};

struct MethodResult {
  std::vector<std::optional<PoseError>> errors;  // one a trial of the short search
  double credit = 0.0;                           // AreaUnderCurve of these
  LongSearch to_the_end;
};

struct QueryResult {
  SegmentId segment = -1;  // the best ranked, whose matches all methods had; -1: none
  std::optional<Scene> scene;
  PoseProblem problem;                             // these matches
  std::array<MethodResult, kMethodCount> methods;  // in the order of kMethods
  LongSearch selection_to_the_end;                 // as its session was left out
  // As the server records a query that it answers with "mixed" and all its means.
  Observation observation;
};

// Of the body's pose; nullopt: none was found.
std::optional<PoseError> ErrorOf(const Attempt& attempt, const SetQuery& query);

// One a query of the session, without the searches to the end. Deterministic, times apart.
Result<std::vector<QueryResult>> RunTrials(const SelectionSet& set, const SetSession& session,
                                           const TrialOptions& options, const ProgressFn& progress);

}  // namespace maploc::selection
