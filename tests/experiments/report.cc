#include "tests/experiments/report.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <system_error>

#include "mapstore/base/table.h"
#include "mapstore/tools/output.h"

namespace maploc::experiments {
namespace {

Status WriteFile(const std::filesystem::path& path, const std::string& content) {
  std::ofstream file(path);
  file << content;
  file.close();
  return file ? Status::Ok()
              : InvalidFile(path.string(), "cannot be written; choose a folder that can");
}

// Rows that no view shows, a table of all their keys.
void PrintAll(const Rows& rows) {
  const std::vector<std::string> keys = KeysOf(rows);
  Table table(keys);
  for (const Row& row : rows) {
    std::vector<std::string> cells;
    for (const std::string& key : keys) cells.push_back(TextOf(row, key));
    table.AddRow(cells);
  }
  table.Print(std::cout);
}

}  // namespace

Status CheckWritable(const ReportOptions& options) {
  if (!options.csv_file.empty()) {
    MAPLOC_RETURN_IF_ERROR(WriteCsv({}, options.csv_file));
  }
  if (options.plot_folder.empty()) return Status::Ok();
  std::error_code error;
  std::filesystem::create_directories(options.plot_folder, error);
  if (error || !std::filesystem::is_directory(options.plot_folder)) {
    return InvalidFile(options.plot_folder, "is not a folder and cannot be made one");
  }
  return Status::Ok();
}

Result<Rows> ReadRows(const std::string& path, const std::string& experiment) {
  std::ifstream file(path);
  const Row document = Row::parse(file, nullptr, false);
  const auto is_row = [&](const Row& row) {
    return row.is_object() && row.contains("method") &&
           row.value("experiment", Row()) == experiment;
  };
  if (!document.is_array() || !std::ranges::all_of(document, is_row)) {
    return InvalidFile(path, "is no list of rows of " + experiment + "; make one with --json");
  }
  return Rows(document.begin(), document.end());
}

Status ReportRows(const Rows& rows, const std::vector<View>& views, const ReportOptions& options) {
  if (!options.csv_file.empty()) MAPLOC_RETURN_IF_ERROR(WriteCsv(rows, options.csv_file));
  if (!options.plot_folder.empty()) {
    for (const View& view : views) {
      MAPLOC_RETURN_IF_ERROR(
          WriteFile(std::filesystem::path(options.plot_folder) / (view.name + ".svg"),
                    DrawSvg(ChartOf(rows, view))));
    }
  }
  if (options.json) return PrintJson(rows), Status::Ok();
  bool shown = false;
  for (const View& view : views) {
    if (!view.is_table) continue;
    PrintTables(rows, view, std::cout);
    shown = true;
  }
  if (!shown) PrintAll(rows);
  return Status::Ok();
}

}  // namespace maploc::experiments
