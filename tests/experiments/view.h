// A look at rows: one value by one key, a line a method, a panel for each combination of the
// others. The same view is a table on a terminal and a chart in a file.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tests/experiments/row.h"
#include "tests/experiments/svg_chart.h"

namespace maploc::experiments {

struct View {
  std::string name;  // of the chart's file, without .svg
  std::string title;
  std::vector<std::string> panel_keys;
  std::string x_key;
  std::string y_key;
  std::string x_label;
  std::string y_label;
  bool log_x = false;
  bool log_y = false;
  bool y_is_share = false;
  std::string series_key = "method";
  bool is_table = true;  // else a chart alone
};

// Rows without `x_key` are not in it.
Chart ChartOf(const Rows& rows, const View& view);

// A table a panel: a line a method, a column a value of `x_key`.
void PrintTables(const Rows& rows, const View& view, std::ostream& out);

}  // namespace maploc::experiments
