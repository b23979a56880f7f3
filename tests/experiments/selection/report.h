// The result as one JSON document (the contract's), as rows, as a chart.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/experiments/row.h"
#include "tests/experiments/selection/run_selection.h"
#include "tests/experiments/svg_chart.h"

namespace maploc::selection {

nlohmann::ordered_json ToJson(const SelectionResult& result);

// A row a session left out (and the whole) and method, for CSV.
experiments::Rows ToRows(const SelectionResult& result);

// Success over the threshold, a panel a session left out.
experiments::Chart SuccessChart(const SelectionResult& result);

}  // namespace maploc::selection
