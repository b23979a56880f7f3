// How a command reports: a table (base/table.h) for people, one JSON document for programs. Both go
// to standard output; progress and warnings go to standard error.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace maploc {

// The document, indented, with a line's end.
void PrintJson(const nlohmann::ordered_json& document);

// "0.734", or "-" where there is no evidence.
std::string FormatRatio(std::optional<double> ratio);
// The number, or JSON's null.
nlohmann::ordered_json JsonRatio(std::optional<double> ratio);

}  // namespace maploc
