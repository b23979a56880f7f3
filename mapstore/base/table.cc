#include "mapstore/base/table.h"

#include <algorithm>
#include <cassert>
#include <ostream>
#include <utility>

namespace maploc {
namespace {

// Columns on a terminal: colour codes and bytes that continue a UTF-8 character take none.
std::size_t WidthOf(const std::string& text) {
  std::size_t width = 0;
  bool in_code = false;
  for (const char c : text) {
    if (c == '\033') in_code = true;
    if (!in_code && (static_cast<unsigned char>(c) & 0xc0) != 0x80) ++width;
    if (in_code && c == 'm') in_code = false;
  }
  return width;
}

}  // namespace

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

}  // namespace maploc
