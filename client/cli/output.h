// How a command reports: a table (base/table.h) for people, one JSON document for programs;
// progress goes to standard error, and only when that is a terminal.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace maploc {

// The document, indented, with a line's end, on standard output.
void PrintJson(const nlohmann::ordered_json& document);
// The value, or JSON's null.
nlohmann::ordered_json JsonOrNull(const std::optional<double>& value);

// Fixed-point with `digits` decimals, or "-" where there is none.
std::string FormatNumber(const std::optional<double>& value, int digits);

enum class Ink { kGreen, kYellow, kRed, kBlue, kGrey, kBold };
// `text` in colour, where standard output is a terminal and NO_COLOR is not set; else as it is.
std::string Colour(Ink ink, const std::string& text);

// A bar on standard error; silent where that is no terminal.
class Progress {
 public:
  Progress(std::string what, int total);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void Advance(const std::string& note);

 private:
  const std::string what_;
  const int total_;
  const bool visible_;
  int done_ = 0;
};

}  // namespace maploc
