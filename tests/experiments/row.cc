#include "tests/experiments/row.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

namespace maploc::experiments {
namespace {

std::string ShortNumber(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

}  // namespace

std::string TextOf(const Row& row, const std::string& key) {
  const auto found = row.find(key);
  if (found == row.end() || found->is_null()) return "";
  if (found->is_string()) return found->get<std::string>();
  if (found->is_number_float()) return ShortNumber(found->get<double>());
  return found->dump();
}

bool HasValue(const Row& row, const std::string& key, const std::string& text) {
  const std::string own = TextOf(row, key);
  if (own == text) return true;
  const Row number = Row::parse(text, nullptr, false);
  return number.is_number() && row.contains(key) && row.at(key).is_number() &&
         ShortNumber(number.get<double>()) == ShortNumber(row.at(key).get<double>());
}

std::vector<std::string> KeysOf(const Rows& rows) {
  std::vector<std::string> keys;
  for (const Row& row : rows) {
    for (const auto& [key, value] : row.items()) {
      if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
    }
  }
  return keys;
}

Status WriteCsv(const Rows& rows, const std::string& path) {
  const std::vector<std::string> keys = KeysOf(rows);
  std::ofstream file(path);
  for (std::size_t i = 0; i < keys.size(); ++i) file << (i > 0 ? "," : "") << keys[i];
  file << "\n";
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      file << (i > 0 ? "," : "") << TextOf(row, keys[i]);
    }
    file << "\n";
  }
  file.close();
  return file ? Status::Ok() : InvalidFile(path, "cannot be written; name a file that can");
}

}  // namespace maploc::experiments
