#include "mapstore/importers/photo_groups.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "mapstore/base/even_sample.h"

namespace maploc {
namespace {

// Of a landmark that more photos see, an even sample of them is paired.
constexpr int kMaxPairedPhotos = 64;

struct Group {
  std::vector<int> frames;  // empty: joined to another
  Eigen::AlignedBox3d centers;
  std::map<int, std::int64_t> shared;  // landmarks, a pair of photos, with each other group
};

std::vector<Group> SinglePhotos(std::span<const KeyFrame> frames,
                                std::span<const PointTrack> points) {
  std::vector<Group> groups(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    groups[i].frames = {static_cast<int>(i)};
    groups[i].centers.extend(frames[i].CenterInMap());
  }
  for (const PointTrack& point : points) {
    const std::vector<int> sample =
        EvenSample(static_cast<int>(point.frames.size()), kMaxPairedPhotos);
    for (const int a : sample) {
      for (const int b : sample) {
        if (a != b) ++groups[point.frames[a]].shared[point.frames[b]];
      }
    }
  }
  return groups;
}

class Grouping {
 public:
  Grouping(std::vector<Group> groups, double extent) : groups_(std::move(groups)), extent_(extent) {
    for (int a = 0; a < static_cast<int>(groups_.size()); ++a) Propose(a);
  }

  std::vector<Group> Run() {
    while (!proposals_.empty()) {
      const auto [weight, minus_a, minus_b] = proposals_.top();
      proposals_.pop();
      // A proposal is outdated where a group has changed since: joined, it has another weight.
      const int a = -minus_a;
      const int b = -minus_b;
      const auto shared = groups_[a].shared.find(b);
      if (shared == groups_[a].shared.end() || Weight(a, b, shared->second) != weight) continue;
      if (!Fit(a, b)) continue;
      Join(a, b);
      Propose(a);
    }
    return std::move(groups_);
  }

 private:
  double Weight(int a, int b, std::int64_t shared) const {
    return static_cast<double>(shared) / (static_cast<double>(groups_[a].frames.size()) *
                                          static_cast<double>(groups_[b].frames.size()));
  }

  bool Fit(int a, int b) const {
    return groups_[a].centers.merged(groups_[b].centers).diagonal().norm() <= extent_;
  }

  void Propose(int a) {
    for (const auto& [b, shared] : groups_[a].shared) {
      proposals_.emplace(Weight(a, b, shared), -std::min(a, b), -std::max(a, b));
    }
  }

  // `b` becomes part of `a`.
  void Join(int a, int b) {
    Group& group = groups_[a];
    Group joined = std::exchange(groups_[b], {});
    group.frames.insert(group.frames.end(), joined.frames.begin(), joined.frames.end());
    group.centers.extend(joined.centers);
    group.shared.erase(b);
    for (const auto& [other, shared] : joined.shared) {
      if (other == a) continue;
      groups_[other].shared.erase(b);
      groups_[other].shared[a] += shared;
      group.shared[other] += shared;
    }
  }

  std::vector<Group> groups_;
  const double extent_;
  // Weight and the two groups, negative: of equal weights the lower groups come first.
  std::priority_queue<std::tuple<double, int, int>> proposals_;
};

}  // namespace

std::vector<std::vector<int>> GroupPhotos(std::span<const KeyFrame> frames,
                                          std::span<const PointTrack> points, double extent) {
  std::vector<std::vector<int>> groups;
  for (Group& group : Grouping(SinglePhotos(frames, points), extent).Run()) {
    if (group.frames.empty()) continue;
    std::ranges::sort(group.frames);
    groups.push_back(std::move(group.frames));
  }
  return groups;
}

}  // namespace maploc
