#include "server/matching/guided_matching.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "mapstore/descriptors/knn.h"

namespace maploc {
namespace {

// Of the known inliers' distances. Not the largest, which a single wrong match would set.
constexpr double kSimilarQuantile = 0.9;

// Cells along the image's longer side, at most. The radius follows the threshold that a client may
// send (max_error_pixels): a tiny one would ask for a grid of gigabytes.
constexpr double kMaxCells = 256.0;

// Features by square cells of the image, not smaller than the radius, so that those within it of a
// pixel lie in nine cells. Features outside of the image are left out.
class FeatureGrid {
 public:
  FeatureGrid(const View& view, double radius_px, const std::vector<char>& left_out)
      : keypoints_px_(view.points.keypoints_px),
        size_px_(view.camera.width_px(), view.camera.height_px()),
        radius_px_(radius_px),
        cell_px_(std::max(radius_px, size_px_.maxCoeff() / kMaxCells)),
        columns_(1 + static_cast<int>(size_px_.x() / cell_px_)),
        rows_(1 + static_cast<int>(size_px_.y() / cell_px_)),
        begin_(static_cast<std::size_t>(columns_) * rows_ + 1, 0) {
    for (std::size_t i = 0; i < keypoints_px_.size(); ++i) {
      if (const std::optional<int> cell = left_out[i] ? std::nullopt : CellOf(i))
        ++begin_[*cell + 1];
    }
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    features_.resize(begin_.back());
    std::vector<std::int32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < keypoints_px_.size(); ++i) {
      const std::optional<int> cell = left_out[i] ? std::nullopt : CellOf(i);
      if (cell) features_[next[*cell]++] = static_cast<std::int32_t>(i);
    }
  }

  // Calls `visit(feature)` for each within the radius of `pixel`.
  template <typename Visit>
  void ForEachNear(const Eigen::Vector2d& pixel, const Visit& visit) const {
    const bool near_image = (pixel.array() > -radius_px_).all() &&
                            (pixel.array() < size_px_.array() + radius_px_).all();
    if (!near_image) return;
    // Near the image by now: what is farther off may be beyond an int.
    const int column = static_cast<int>(std::floor(pixel.x() / cell_px_));
    const int row = static_cast<int>(std::floor(pixel.y() / cell_px_));
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows_ - 1); ++r) {
      for (int c = std::max(column - 1, 0); c <= std::min(column + 1, columns_ - 1); ++c) {
        const std::size_t cell = static_cast<std::size_t>(r) * columns_ + c;
        for (std::int32_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
          const Eigen::Vector2d feature_px = keypoints_px_[features_[i]].cast<double>();
          if ((feature_px - pixel).squaredNorm() < radius_px_ * radius_px_) visit(features_[i]);
        }
      }
    }
  }

 private:
  std::optional<int> CellOf(std::size_t feature) const {
    const Eigen::Vector2d pixel = keypoints_px_[feature].cast<double>();
    const bool inside = (pixel.array() >= 0).all() && (pixel.array() <= size_px_.array()).all();
    if (!inside) return std::nullopt;
    const int column = static_cast<int>(pixel.x() / cell_px_);
    const int row = static_cast<int>(pixel.y() / cell_px_);
    return row * columns_ + column;
  }

  const std::vector<Eigen::Vector2f>& keypoints_px_;
  Eigen::Vector2d size_px_;
  double radius_px_;
  double cell_px_;
  int columns_;
  int rows_;
  std::vector<std::int32_t> begin_;  // of each cell in features_, and the end
  std::vector<std::int32_t> features_;
};

// Distances of features to landmarks: to the nearest of a landmark's rows.
class Similarity {
 public:
  Similarity(const View& view, const Segment& segment)
      : features_(view.points.descriptors),
        rows_(segment.points.descriptors),
        begin_(segment.points.size() + 1, 0) {
    // A segment's rows ascend by landmark, so that those of one stand together.
    for (const std::int32_t landmark : segment.points.descriptor_landmark) ++begin_[landmark + 1];
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  }

  std::uint32_t Distance(std::int32_t feature, std::int32_t landmark) const {
    std::uint32_t nearest = UINT32_MAX;
    for (std::int32_t row = begin_[landmark]; row < begin_[landmark + 1]; ++row) {
      nearest = std::min(
          nearest, DescriptorDistance(rows_.kind.metric, features_.row(feature), rows_.row(row)));
    }
    return nearest;
  }

 private:
  const Descriptors& features_;
  const Descriptors& rows_;
  std::vector<std::int32_t> begin_;  // of each landmark's rows, and the end
};

// A bound on the distance of two descriptors of one landmark, as the known inliers have it.
std::uint32_t SimilarDistance(const Similarity& similarity, std::span<const FeatureMatch> known,
                              std::span<const std::uint8_t> known_inlier) {
  std::vector<std::uint32_t> distances;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (known_inlier[i] == 0) continue;
    distances.push_back(similarity.Distance(known[i].feature, known[i].landmark));
  }
  const auto at = distances.begin() +
                  static_cast<std::ptrdiff_t>(kSimilarQuantile * (std::ssize(distances) - 1));
  std::nth_element(distances.begin(), at, distances.end());
  return *at;
}

// The nearest feature or landmark so far, the first of equals.
struct Nearest {
  std::int32_t index = -1;
  std::uint32_t distance = 0;

  void Take(std::int32_t candidate, std::uint32_t candidate_distance) {
    if (index >= 0 && candidate_distance >= distance) return;
    index = candidate;
    distance = candidate_distance;
  }
};

}  // namespace

std::vector<FeatureMatch> MatchNearProjections(const View& view, const Segment& segment,
                                               const Rigid3& camera_from_map, double radius_px,
                                               std::span<const FeatureMatch> known,
                                               std::span<const std::uint8_t> known_inlier) {
  std::vector<char> feature_known(view.points.keypoints_px.size(), 0);
  std::vector<char> landmark_known(segment.points.size(), 0);
  for (const FeatureMatch& match : known) {
    feature_known[match.feature] = 1;
    landmark_known[match.landmark] = 1;
  }
  const FeatureGrid grid(view, radius_px, feature_known);
  const Similarity similarity(view, segment);
  const std::uint32_t similar = SimilarDistance(similarity, known, known_inlier);
  std::vector<Nearest> landmark_of(view.points.keypoints_px.size());
  for (std::int32_t landmark = 0; landmark < segment.points.size(); ++landmark) {
    if (landmark_known[landmark] != 0) continue;
    const std::optional<Eigen::Vector2d> pixel =
        view.camera.Project(camera_from_map * segment.points.positions_in_map[landmark]);
    if (!pixel) continue;
    Nearest nearest;
    grid.ForEachNear(*pixel, [&](std::int32_t feature) {
      const std::uint32_t distance = similarity.Distance(feature, landmark);
      if (distance <= similar) nearest.Take(feature, distance);
    });
    if (nearest.index >= 0) landmark_of[nearest.index].Take(landmark, nearest.distance);
  }
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < landmark_of.size(); ++i) {
    if (landmark_of[i].index < 0) continue;
    matches.push_back({static_cast<std::int32_t>(i), landmark_of[i].index, 1.0f});
  }
  return matches;
}

}  // namespace maploc
