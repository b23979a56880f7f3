// Where rows go: one JSON document or tables on standard output, a CSV file, a chart a view.
#pragma once

#include <string>
#include <vector>

#include "tests/experiments/row.h"
#include "tests/experiments/view.h"

namespace maploc::experiments {

struct ReportOptions {
  bool json = false;
  std::string earlier_file;  // empty: none; rows of an earlier --json, shown after the new ones
  std::string csv_file;      // empty: none
  std::string plot_folder;   // empty: none; made where it is missing
};

// Fails where a file cannot be written: asked before hours are spent on an experiment.
Status CheckWritable(const ReportOptions& options);

// The rows of an earlier run's --json. Fails where the file holds no list of rows of `experiment`.
Result<Rows> ReadRows(const std::string& path, const std::string& experiment);

Status ReportRows(const Rows& rows, const std::vector<View>& views, const ReportOptions& options);

}  // namespace maploc::experiments
