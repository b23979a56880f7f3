// A row of results: keys and values in order, as interface.md names them. Everything that reports
// (JSON, CSV, tables, charts) works on rows alone.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "mapstore/base/status.h"

namespace maploc::experiments {

using Row = nlohmann::ordered_json;  // an object; what does not apply is left out
using Rows = std::vector<Row>;

// A value for people: numbers short, strings without quotes, nothing for a missing key.
std::string TextOf(const Row& row, const std::string& key);

// Whether a row has this value under the key, as a person writes it: 0, 0.0 and "0" are one.
bool HasValue(const Row& row, const std::string& key, const std::string& text);

// All keys of all rows, in the order in which they first appear.
std::vector<std::string> KeysOf(const Rows& rows);

// A header and a line a row; empty where a row lacks the key.
Status WriteCsv(const Rows& rows, const std::string& path);

}  // namespace maploc::experiments
