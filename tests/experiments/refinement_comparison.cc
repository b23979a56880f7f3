#include "tests/experiments/refinement_comparison.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace maploc::experiments {
namespace {

constexpr std::string_view kAuto = "-auto";

// What a row says of its setting: all but the method and its results.
bool SameSetting(const Row& a, const Row& b) {
  return std::ranges::all_of(std::array{"inliers", "outlier_rate", "noise_px", "gravity_noise_deg"},
                             [&](const char* key) { return TextOf(a, key) == TextOf(b, key); });
}

const Row* Find(const Rows& rows, const Row& like, const std::string& method) {
  const auto found = std::ranges::find_if(
      rows, [&](const Row& row) { return row.at("method") == method && SameSetting(row, like); });
  return found == rows.end() ? nullptr : &*found;
}

void Compare(Row& row, const Row& held, const Row& free, const std::string& key,
             const std::string& name) {
  if (!row.contains(key) || !held.contains(key) || !free.contains(key)) return;
  const double error = row.at(key);
  const auto [better, worse] =
      std::minmax({held.at(key).get<double>(), free.at(key).get<double>()});
  if (!(better > 0)) return;
  row[name + "_to_better"] = error / better;
  row[name + "_to_worse"] = error / worse;
}

}  // namespace

Rows WithRefinementComparison(Rows rows) {
  for (Row& row : rows) {
    const std::string method = row.at("method");
    if (!method.ends_with(kAuto) || row.value("noise_px", 1.0) <= 0) continue;
    const std::string stem = method.substr(0, method.size() - kAuto.size());
    const Row* held = Find(rows, row, stem + "-4dof");
    const Row* free = Find(rows, row, stem + "-6dof");
    if (held == nullptr || free == nullptr) continue;
    Compare(row, *held, *free, "median_rotation_error_deg", "rotation");
    Compare(row, *held, *free, "median_translation_error_percent", "translation");
  }
  return rows;
}

}  // namespace maploc::experiments
