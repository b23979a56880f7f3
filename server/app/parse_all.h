// Parsing for --check-config: every fault of flags, environment and file is told, not only the
// first, and of every option its value and where that comes from.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace maploc {

struct OptionValue {
  std::string option;  // "--listen"
  std::string value;   // in force; the default where the given one is a fault
  std::string from;    // "flag", "environment", "file", "default"
};

struct ParsedOptions {
  std::vector<OptionValue> values;
  std::vector<std::string> faults;
};

// `environment` and `flags` are arguments ("--listen=x" or "--listen", "x"); the latter win. `app`
// may not parse again.
ParsedOptions ParseAll(CLI::App& app, const std::vector<std::string>& environment,
                       const std::vector<std::string>& flags);

}  // namespace maploc
