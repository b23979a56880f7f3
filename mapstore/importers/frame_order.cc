#include "mapstore/importers/frame_order.h"

#include <algorithm>
#include <numeric>
#include <string_view>

namespace maploc {
namespace {

constexpr double kMaxDetour = 2.0;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

std::string_view TakeDigits(std::string_view& text) {
  std::size_t count = 0;
  while (count < text.size() && IsDigit(text[count])) ++count;
  std::string_view digits = text.substr(0, count);
  text.remove_prefix(count);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

// Numbers compare by value, however long.
bool NaturallyBefore(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (IsDigit(a[0]) && IsDigit(b[0])) {
      const std::string_view number_a = TakeDigits(a);
      const std::string_view number_b = TakeDigits(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a[0] != b[0]) return a[0] < b[0];
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return a.size() < b.size();
}

std::vector<int> OrderByName(std::span<const KeyFrame> frames) {
  std::vector<int> order(frames.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    // Names that differ only in leading zeros are equal in natural order. Their characters then
    // decide.
    if (NaturallyBefore(frames[a].name, frames[b].name)) return true;
    return !NaturallyBefore(frames[b].name, frames[a].name) && frames[a].name < frames[b].name;
  });
  return order;
}

}  // namespace

std::optional<std::vector<int>> RecordedOrder(std::span<const KeyFrame> frames) {
  std::vector<int> by_name = OrderByName(frames);
  const double detour = PathLength(frames, by_name);
  if (detour > kMaxDetour * PathLength(frames, OrderByNearness(frames, by_name)) + 1e-9) return {};
  return by_name;
}

std::vector<int> OrderByNearness(std::span<const KeyFrame> frames, const std::vector<int>& subset) {
  std::vector<Eigen::Vector3d> centers;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const int frame : subset) {
    centers.push_back(frames[frame].CenterInMap());
    middle += centers.back() / static_cast<double>(subset.size());
  }
  std::vector<int> left(subset.size());  // places in `subset`
  std::iota(left.begin(), left.end(), 0);
  const auto nearer_to = [&centers](const Eigen::Vector3d& from) {
    return [&centers, from](int a, int b) {
      return (centers[a] - from).squaredNorm() < (centers[b] - from).squaredNorm();
    };
  };
  std::vector<int> order;
  // From an end: a chain from the middle would have to jump back for its other half.
  auto next = std::max_element(left.begin(), left.end(), nearer_to(middle));
  while (next != left.end()) {
    const int place = *next;
    order.push_back(subset[place]);
    left.erase(next);
    next = std::min_element(left.begin(), left.end(), nearer_to(centers[place]));
  }
  return order;
}

double PathLength(std::span<const KeyFrame> frames, const std::vector<int>& order) {
  double length = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    length += (frames[order[i]].CenterInMap() - frames[order[i - 1]].CenterInMap()).norm();
  }
  return length;
}

}  // namespace maploc
