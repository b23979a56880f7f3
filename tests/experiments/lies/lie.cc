#include "tests/experiments/lies/lie.h"

#include <algorithm>
#include <numeric>

namespace maploc::lies {
namespace {

std::vector<Lie> HonestOnes() {
  const auto as_recorded = [](const HonestQuery& honest, int, Random&) -> Result<Query> {
    return honest.query;
  };
  const auto without_gravity = [](const HonestQuery& honest, int, Random&) -> Result<Query> {
    Query query = honest.query;
    query.gravity.reset();
    return query;
  };
  return {{"honest", "as recorded", false, as_recorded},
          {"honest", "no gravity", false, without_gravity}};
}

}  // namespace

std::vector<Lie> AllLies() {
  std::vector<Lie> lies = HonestOnes();
  for (const std::vector<Lie>& family : {GravityLies(), CalibrationLies(), FeatureLies()}) {
    lies.insert(lies.end(), family.begin(), family.end());
  }
  return lies;
}

void KeepSomePoints(int count, Random& random, PointFeatures& points) {
  const int size = static_cast<int>(points.keypoints_px.size());
  if (size <= count) return;
  std::vector<int> kept(size);
  std::iota(kept.begin(), kept.end(), 0);
  for (int i = 0; i < count; ++i) {
    std::swap(kept[i], kept[i + static_cast<int>(random.Below(size - i))]);
  }
  kept.resize(count);
  std::ranges::sort(kept);
  PointFeatures some{{}, {points.descriptors.kind, {}}};
  for (const int i : kept) {
    const auto row = points.descriptors.row(i);
    some.keypoints_px.push_back(points.keypoints_px[i]);
    some.descriptors.bytes.insert(some.descriptors.bytes.end(), row.begin(), row.end());
  }
  points = std::move(some);
}

}  // namespace maploc::lies
