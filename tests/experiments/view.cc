#include "tests/experiments/view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include "mapstore/base/table.h"
#include "mapstore/base/text.h"

namespace maploc::experiments {
namespace {

// A key with its value, for people.
std::string KeyText(const Row& row, const std::string& key) {
  const std::string value = TextOf(row, key);
  if (key == "gravity_noise_deg") return "gravity noise " + value + " degrees";
  if (key == "population") return value;
  return value + " " + key;  // "10 inliers", "1000 points"
}

std::string PanelTitle(const Row& row, const View& view) {
  std::string title;
  for (const std::string& key : view.panel_keys) {
    if (row.contains(key)) title += (title.empty() ? "" : ", ") + KeyText(row, key);
  }
  return title;
}

// The element with the name; a new one at the end where there is none.
template <typename T>
T& Named(std::vector<T>& all, std::string T::*member, const std::string& name) {
  const auto found = std::ranges::find(all, name, member);
  if (found != all.end()) return *found;
  all.emplace_back();
  all.back().*member = name;
  return all.back();
}

std::vector<double> ColumnsOf(const ChartPanel& panel) {
  std::vector<double> columns;
  for (const ChartSeries& series : panel.series) {
    for (const ChartPoint& point : series.points) columns.push_back(point.x);
  }
  std::ranges::sort(columns);
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

std::string Cell(const ChartSeries& series, double column, bool share) {
  const auto found = std::ranges::find(series.points, column, &ChartPoint::x);
  if (found == series.points.end() || !std::isfinite(found->y)) return "-";
  if (share) return FixedText(found->y, 3);
  return TextOf(Row{{"value", found->y}}, "value");
}

}  // namespace

Chart ChartOf(const Rows& rows, const View& view) {
  Chart chart;
  chart.title = view.title;
  chart.x_label = view.x_label;
  chart.y_label = view.y_label;
  chart.log_x = view.log_x;
  chart.log_y = view.log_y;
  chart.y_is_share = view.y_is_share;
  for (const Row& row : rows) {
    if (!row.contains(view.x_key) || !row.contains(view.series_key)) continue;
    ChartPanel& panel = Named(chart.panels, &ChartPanel::title, PanelTitle(row, view));
    const double y = row.contains(view.y_key) ? row.at(view.y_key).get<double>()
                                              : std::numeric_limits<double>::quiet_NaN();
    Named(panel.series, &ChartSeries::name, TextOf(row, view.series_key))
        .points.push_back({row.at(view.x_key).get<double>(), y});
  }
  return chart;
}

void PrintTables(const Rows& rows, const View& view, std::ostream& out) {
  const Chart chart = ChartOf(rows, view);
  out << view.title << "\n";
  for (const ChartPanel& panel : chart.panels) {
    const std::vector<double> columns = ColumnsOf(panel);
    std::vector<std::string> header = {view.series_key + " \\ " + view.x_key};
    for (const double column : columns) {
      header.push_back(TextOf(Row{{"value", column}}, "value"));
    }
    Table table(header);
    for (const ChartSeries& series : panel.series) {
      std::vector<std::string> cells = {series.name};
      for (const double column : columns) cells.push_back(Cell(series, column, view.y_is_share));
      table.AddRow(cells);
    }
    out << "\n" << panel.title << "\n";
    table.Print(out);
  }
  out << "\n";
}

}  // namespace maploc::experiments
