// The result as the paper's tables I (whole), II (structured, unstructured) and III (area under the
// curve), the second pass, and what every segment learned.
#pragma once

#include <iosfwd>

#include "tests/experiments/selection/run_selection.h"

namespace maploc::selection {

void PrintTables(const SelectionResult& result, std::ostream& out);

}  // namespace maploc::selection
