// The selection experiment from its flags to its result.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/experiments/selection/leave_one_out.h"

namespace maploc::selection {

struct SelectionFlags {
  std::string set = "campus";  // or a folder: recorded_folder.h
  std::vector<std::string> methods{kMethods.begin(), kMethods.end()};  // that are reported
  int queries = 240;                                                   // a session of the campus
  std::optional<Eigen::Vector3d> gravity_in_source;                    // of a folder
  TrialOptions trials;
  SelectorOptions selector;
};

struct SelectionResult {
  SelectionFlags flags;
  std::vector<SessionResult> sessions;  // in the order of time
  std::vector<LeftOut> left_out;        // one a session, in the same order
};

Result<SelectionResult> RunSelection(const SelectionFlags& flags, const ProgressFn& progress);

}  // namespace maploc::selection
