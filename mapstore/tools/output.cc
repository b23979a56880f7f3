#include "mapstore/tools/output.h"

#include <iostream>

#include "mapstore/base/text.h"

namespace maploc {

void PrintJson(const nlohmann::ordered_json& document) {
  // A name that is not UTF-8 must not keep the rest from being read.
  std::cout << document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
            << "\n";
}

std::string FormatRatio(std::optional<double> ratio) { return ratio ? FixedText(*ratio, 3) : "-"; }

nlohmann::ordered_json JsonRatio(std::optional<double> ratio) {
  return ratio ? nlohmann::ordered_json(*ratio) : nlohmann::ordered_json(nullptr);
}

}  // namespace maploc
