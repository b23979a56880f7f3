#include "mapstore/importers/model_points.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "mapstore/importers/descriptor_selection.h"

namespace maploc {
namespace {

Status CheckKeypoints(const ColmapImage& image, const ColmapFeatures& features) {
  const std::vector<Eigen::Vector2f>& stored = features.points.keypoints_px;
  const std::string cure = "; is it the database that the model was made from?";
  if (stored.size() < image.keypoints_px.size()) {
    return FailedPrecondition("DATABASE_MISMATCH",
                              "database: image '" + image.name + "' has " +
                                  std::to_string(stored.size()) + " keypoints, the model has " +
                                  std::to_string(image.keypoints_px.size()) + cure);
  }
  for (std::size_t i = 0; i < image.keypoints_px.size(); ++i) {
    if (!((stored[i].cast<double>() - image.keypoints_px[i]).norm() < 1.0)) {
      return FailedPrecondition("DATABASE_MISMATCH", "database: keypoint " + std::to_string(i) +
                                                         " of image '" + image.name +
                                                         "' is not where the model has it" + cure);
    }
  }
  return Status::Ok();
}

// A grid of cells as wide as the search radius, so that a search looks at nine of them.
class PixelGrid {
 public:
  PixelGrid(const std::vector<Eigen::Vector2f>& points, double cell_px)
      : points_(points), cell_px_(cell_px) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      cells_[Key(Cell(points[i].x()), Cell(points[i].y()))].push_back(static_cast<int>(i));
    }
  }
  // The nearest point within one cell's width, or -1.
  int Nearest(const Eigen::Vector2d& pixel) const {
    int best = -1;
    double best_distance = cell_px_;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto cell = cells_.find(Key(Cell(pixel.x()) + dx, Cell(pixel.y()) + dy));
        if (cell == cells_.end()) continue;
        for (const int i : cell->second) {
          const double distance =
              (points_[static_cast<std::size_t>(i)].cast<double>() - pixel).norm();
          if (distance > best_distance || (best >= 0 && distance == best_distance)) continue;
          best = i;
          best_distance = distance;
        }
      }
    }
    return best;
  }

 private:
  std::int64_t Cell(double position) const {
    // Clamped, because the cell of a wild coordinate would not fit an integer.
    return static_cast<std::int64_t>(std::floor(std::clamp(position, -1e8, 1e8) / cell_px_));
  }
  static std::int64_t Key(std::int64_t x, std::int64_t y) {
    // |y| is at most 1e8, so no two cells have the same key.
    return x * (std::int64_t{1} << 31) + y;
  }

  const std::vector<Eigen::Vector2f>& points_;
  double cell_px_;
  std::unordered_map<std::int64_t, std::vector<int>> cells_;
};

}  // namespace

Result<std::vector<KeypointFeatures>> TakeFromDatabase(
    const ColmapModel& model, std::span<const KeyFrame> frames,
    std::map<std::string, ColmapFeatures> database) {
  std::vector<KeypointFeatures> taken;
  for (const KeyFrame& frame : frames) {
    const ColmapImage& image = model.images.at(frame.image_id);
    const auto found = database.find(frame.name);
    if (found == database.end()) {
      return FailedPrecondition("DATABASE_MISMATCH",
                                "database: has no image '" + frame.name +
                                    "'; is it the database that the model was made from?");
    }
    MAPLOC_RETURN_IF_ERROR(CheckKeypoints(image, found->second));
    KeypointFeatures features{std::move(found->second.points.descriptors), {}};
    for (std::size_t i = 0; i < image.keypoints_px.size(); ++i) {
      features.row_of_keypoint.push_back(static_cast<std::int32_t>(i));
    }
    taken.push_back(std::move(features));
  }
  return taken;
}

KeypointFeatures AttachFeatures(const ColmapImage& image, const PointFeatures& features,
                                double max_distance_px) {
  const PixelGrid grid(features.keypoints_px, max_distance_px);
  KeypointFeatures attached{features.descriptors, {}};
  for (std::size_t i = 0; i < image.keypoints_px.size(); ++i) {
    const bool saw_point = image.point_ids[i] >= 0;
    attached.row_of_keypoint.push_back(saw_point ? grid.Nearest(image.keypoints_px[i]) : -1);
  }
  return attached;
}

std::vector<PointTrack> MakePointTracks(const ColmapModel& model,
                                        const Similarity3& map_from_source,
                                        std::span<const KeyFrame> frames,
                                        std::span<const KeypointFeatures> features,
                                        int max_descriptors) {
  std::unordered_map<std::int64_t, std::int32_t> frame_of_image;
  for (const KeyFrame& frame : frames) {
    frame_of_image.emplace(frame.image_id, static_cast<std::int32_t>(frame_of_image.size()));
  }
  std::vector<PointTrack> tracks;
  for (const auto& [id, point] : model.points) {
    PointTrack track{map_from_source * point.position_in_source, {}, {}};
    DescriptorKind kind;
    for (const ColmapPoint::Observation& observation : point.track) {
      const std::int32_t frame = frame_of_image.at(observation.image_id);
      track.frames.push_back(frame);
      const KeypointFeatures& of_frame = features[static_cast<std::size_t>(frame)];
      const std::int32_t row =
          of_frame.row_of_keypoint[static_cast<std::size_t>(observation.keypoint)];
      if (row < 0) continue;
      kind = of_frame.descriptors.kind;
      const std::span<const std::uint8_t> bytes = of_frame.descriptors.row(row);
      track.descriptors.insert(track.descriptors.end(), bytes.begin(), bytes.end());
    }
    if (track.descriptors.empty()) continue;
    // A track can name two keypoints of one image.
    std::sort(track.frames.begin(), track.frames.end());
    track.frames.erase(std::unique(track.frames.begin(), track.frames.end()), track.frames.end());
    track.descriptors = SelectDescriptors(kind, track.descriptors, max_descriptors);
    tracks.push_back(std::move(track));
  }
  return tracks;
}

}  // namespace maploc
