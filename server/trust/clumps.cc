#include "server/trust/clumps.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

namespace maploc {
namespace {

constexpr int kMostInClump = 2;

// A forest in which the points of a clump have one root.
class Forest {
 public:
  explicit Forest(std::size_t size) : parents_(size) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }

  std::size_t Root(std::size_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void Join(std::size_t i, std::size_t j) { parents_[Root(j)] = Root(i); }

 private:
  std::vector<std::size_t> parents_;
};

struct Clump {
  Eigen::AlignedBox2d box;
  int points = 0;
};

std::vector<Clump> FindClumps(const std::vector<Eigen::Vector2d>& from_left, double gap) {
  Forest forest(from_left.size());
  for (std::size_t i = 0; i < from_left.size(); ++i) {
    for (std::size_t j = i; j-- > 0 && from_left[i].x() - from_left[j].x() < gap;) {
      if ((from_left[i] - from_left[j]).squaredNorm() < gap * gap) forest.Join(i, j);
    }
  }
  std::vector<Clump> clumps(from_left.size());  // at their roots; the others stay empty
  for (std::size_t i = 0; i < from_left.size(); ++i) {
    Clump& clump = clumps[forest.Root(i)];
    clump.box.extend(from_left[i]);
    ++clump.points;
  }
  return clumps;
}

}  // namespace

int CountByClumps(std::vector<Eigen::Vector2d> points, double gap, double width) {
  std::sort(points.begin(), points.end(),
            [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() < b.x(); });
  int count = 0;
  for (const Clump& clump : FindClumps(points, gap)) {
    if (clump.points == 0) continue;
    const bool is_small = clump.box.diagonal().norm() <= width;
    count += is_small ? std::min(clump.points, kMostInClump) : clump.points;
  }
  return count;
}

}  // namespace maploc
