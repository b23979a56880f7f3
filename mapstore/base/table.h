// A report's table for people: columns padded to their widest cell, the header underlined.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace maploc {

class Table {
 public:
  explicit Table(std::vector<std::string> header);
  // REQUIRES: as many cells as the header. They may hold colour codes (ESC ... m) and UTF-8: only
  // what is seen takes width.
  void AddRow(std::vector<std::string> cells);
  void Print(std::ostream& out) const;

 private:
  std::vector<std::vector<std::string>> rows_;  // the header first
};

}  // namespace maploc
