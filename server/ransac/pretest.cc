#include "server/ransac/pretest.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace maploc {
namespace {

constexpr double kBlockScore = 3.0;
// A block of more than this share of the features is no cheaper than all of them.
constexpr double kMaxShare = 0.5;

std::size_t Padded(double share, std::size_t size) {
  const double pads = std::ceil(share * static_cast<double>(size) / kScoringPad);
  return std::min(size, kScoringPad * static_cast<std::size_t>(pads));
}

// Where a block of `block` out of `size` begins.
std::size_t DrawBegin(std::size_t size, std::size_t block, Random& random) {
  return kScoringPad * random.Below(static_cast<std::uint32_t>((size - block) / kScoringPad + 1));
}

// How many of the sample's own features stand in the block: they agree anyway.
int CountOwn(const std::uint32_t* features, int count, const Places& places, std::size_t begin,
             std::size_t size) {
  return static_cast<int>(std::count_if(features, features + count, [&](std::uint32_t feature) {
    // Unsigned: a place before `begin` wraps round to a large one.
    return places.of_feature[feature] - begin < size;
  }));
}

}  // namespace

Pretest::Pretest(const PreparedProblem& prepared, const ScoringOptions& options)
    : prepared_(prepared), options_(options) {}

void Pretest::Update(double best_score) {
  const double share = kBlockScore / std::max(best_score, 1e-9);
  const std::size_t all_points = prepared_.point_arrays.x.size();
  const std::size_t all_lines = prepared_.line_arrays.x.size();
  useful_ = false;
  if (share > kMaxShare) return;
  points_ = Padded(share, all_points);
  lines_ = Padded(share, all_lines);
  useful_ = static_cast<double>(points_ + lines_) <=
            kMaxShare * static_cast<double>(all_points + all_lines);
}

bool Pretest::Passes(const Sample& sample, const ScoringPose& pose, Random& random) const {
  if (!useful_) return true;
  if (lines_ > 0) {
    const std::size_t begin = DrawBegin(prepared_.line_arrays.x.size(), lines_, random);
    const int own = CountOwn(sample.lines, sample.line_count, prepared_.line_places, begin, lines_);
    const Support support =
        ScoreLines(prepared_.line_arrays, begin, begin + lines_, pose, options_);
    if (support.inliers > own) return true;
  }
  if (points_ == 0) return false;
  const std::size_t begin = DrawBegin(prepared_.point_arrays.x.size(), points_, random);
  const int own =
      CountOwn(sample.points, sample.point_count, prepared_.point_places, begin, points_);
  return CountScoringPoints(prepared_.point_arrays, begin, begin + points_, pose, options_) > own;
}

}  // namespace maploc
