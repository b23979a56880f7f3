// How a command reports: a table for people, one JSON document for programs. Both go to standard
// output; progress and warnings go to standard error.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace maploc {

// The document, indented, with a line's end.
void PrintJson(const nlohmann::ordered_json& document);

// Columns padded to their widest cell, the header underlined. Every row has as many cells as the
// header.
class Table {
 public:
  explicit Table(std::vector<std::string> header);
  void AddRow(std::vector<std::string> cells);
  void Print(std::ostream& out) const;

 private:
  std::vector<std::vector<std::string>> rows_;  // the header first
};

// "0.734", or "-" where there is no evidence.
std::string FormatRatio(std::optional<double> ratio);
// The number, or JSON's null.
nlohmann::ordered_json JsonRatio(std::optional<double> ratio);

}  // namespace maploc
