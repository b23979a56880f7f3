#include "client/robot/missing.h"

#include <algorithm>

namespace maploc {

std::string MissingText(const std::vector<std::string>& names, std::size_t total,
                        const std::string& what) {
  return ListText(names, total, "images have no " + what);
}

std::string ListText(const std::vector<std::string>& names, std::size_t total,
                     const std::string& what) {
  constexpr std::size_t kShown = 3;
  std::string text =
      std::to_string(names.size()) + " of " + std::to_string(total) + " " + what + ":";
  for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i) {
    text += (i == 0 ? " '" : ", '") + names[i] + "'";
  }
  return text + (names.size() > kShown ? ", ..." : "");
}

}  // namespace maploc
