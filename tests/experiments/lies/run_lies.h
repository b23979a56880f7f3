// Every lie on every honest query of the real sets, through the product's localizer.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/model/strategy.h"
#include "tests/experiments/row.h"

namespace maploc::lies {

struct LieOptions {
  std::string data_folder;
  std::vector<std::string> sets;      // names of SetNames()
  std::vector<std::string> families;  // empty: all
  int draws = 1;                      // a random lie is told so often a query
  std::uint64_t seed = 1;
  Refinement refinement = Refinement::kAuto;
  bool verbose = false;  // each answer that is off, on standard error
};

// A row a set and lie. A lie that does not apply to a query is left out.
Result<experiments::Rows> RunLies(const LieOptions& options);

}  // namespace maploc::lies
