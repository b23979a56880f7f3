#include "mapstore/tools/output.h"

#include <algorithm>
#include <cassert>
#include <iostream>

#include "mapstore/statistics/text.h"

namespace maploc {
namespace {

// Columns on a terminal: a name's bytes that continue a UTF-8 character take none.
std::size_t WidthOf(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

}  // namespace

void PrintJson(const nlohmann::ordered_json& document) {
  // A name that is not UTF-8 must not keep the rest from being read.
  std::cout << document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
            << "\n";
}

Table::Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }

void Table::AddRow(std::vector<std::string> cells) {
  assert(cells.size() == rows_.front().size());
  rows_.push_back(std::move(cells));
}

void Table::Print(std::ostream& out) const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], WidthOf(row[i]));
  }
  const auto print_row = [&](const std::vector<std::string>& row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      out << row[i];
      const bool last = i + 1 == row.size();
      out << (last ? "\n" : std::string(widths[i] - WidthOf(row[i]) + 2, ' '));
    }
  };
  print_row(rows_.front());
  std::vector<std::string> rule;
  for (const std::size_t width : widths) rule.emplace_back(width, '-');
  print_row(rule);
  std::for_each(rows_.begin() + 1, rows_.end(), print_row);
}

std::string FormatRatio(std::optional<double> ratio) { return ratio ? FixedText(*ratio, 3) : "-"; }

nlohmann::ordered_json JsonRatio(std::optional<double> ratio) {
  return ratio ? nlohmann::ordered_json(*ratio) : nlohmann::ordered_json(nullptr);
}

}  // namespace maploc
