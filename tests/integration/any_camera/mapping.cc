#include <cstdio>
#include <map>

#include "mapstore/formats/colmap_writer.h"
#include "mapstore/formats/line_tracks.h"
#include "tests/integration/any_camera/place.h"

namespace maploc::testing {
namespace {

constexpr int kLeastViews = 2;

// One drive through the place.
class Mapping {
 public:
  Mapping(const Place& place, const Camera& lens, double noise_px, Random& random)
      : place_(place), lens_(lens), noise_px_(noise_px), random_(random) {
    model_.cameras.emplace(1, lens);
    for (std::size_t i = 0; i < place.camera_from_map.size(); ++i) {
      AddFrame(static_cast<std::int64_t>(i) + 1, place.camera_from_map[i]);
    }
    AddPoints();
    AddLines();
  }

  Status Write(const std::string& directory) const {
    MAPLOC_RETURN_IF_ERROR(WriteColmapModel(directory + "/model", model_));
    MAPLOC_RETURN_IF_ERROR(WriteColmapDatabase(directory + "/database.db", model_, features_));
    return WriteLineTracks(directory + "/lines.txt", lines_);
  }

 private:
  bool IsSeen(const Rigid3& camera_from_map, const Eigen::Vector3d& position) const {
    const Eigen::Vector3d in_camera = camera_from_map * position;
    const auto pixel = lens_.Project(in_camera);
    return in_camera.norm() < place_.range_m && pixel && IsInImage(lens_, *pixel);
  }

  void AddFrame(std::int64_t id, const Rigid3& camera_from_map) {
    char name[32];
    std::snprintf(name, sizeof(name), "map/%04d", static_cast<int>(id));
    ColmapImage image{id, 1, name, camera_from_map, {}, {}};
    PointFeatures features;
    features.descriptors.kind = *DescriptorKindFromName("orb");
    for (std::size_t i = 0; i < place_.points.size(); ++i) {
      if (!IsSeen(camera_from_map, place_.points[i].position)) continue;
      point_tracks_[i].push_back({id, static_cast<std::int32_t>(image.keypoints_px.size())});
      image.keypoints_px.push_back(
          *lens_.Project(camera_from_map * place_.points[i].position) +
          Eigen::Vector2d(random_.Gaussian(noise_px_), random_.Gaussian(noise_px_)));
      image.point_ids.push_back(-1);
      features.keypoints_px.push_back(image.keypoints_px.back().cast<float>());
      const BinaryDescriptor& row = place_.points[i].descriptor;
      features.descriptors.bytes.insert(features.descriptors.bytes.end(), row.begin(), row.end());
    }
    for (std::size_t i = 0; i < place_.lines.size(); ++i) {
      const LineSegment3& segment = place_.lines[i].segment;
      if (IsSeen(camera_from_map, segment.start) && IsSeen(camera_from_map, segment.end)) {
        line_images_[i].push_back(id);
      }
    }
    features_.emplace(image.name, std::move(features));
    model_.images.emplace(id, std::move(image));
  }

  void AddPoints() {
    for (const auto& [index, track] : point_tracks_) {
      if (static_cast<int>(track.size()) < kLeastViews) continue;
      const auto id = static_cast<std::int64_t>(index) + 1;
      model_.points.emplace(id, ColmapPoint{id, place_.points[index].position, noise_px_, track});
      for (const ColmapPoint::Observation& seen : track) {
        model_.images.at(seen.image_id).point_ids[static_cast<std::size_t>(seen.keypoint)] = id;
      }
    }
  }

  void AddLines() {
    lines_.descriptors.kind = *DescriptorKindFromName("lbd");
    for (const auto& [index, images] : line_images_) {
      if (static_cast<int>(images.size()) < kLeastViews) continue;
      const Place::Line& line = place_.lines[index];
      lines_.descriptor_track.push_back(static_cast<std::int32_t>(lines_.tracks.size()));
      lines_.descriptors.bytes.insert(lines_.descriptors.bytes.end(), line.descriptor.begin(),
                                      line.descriptor.end());
      lines_.tracks.push_back({static_cast<std::int64_t>(index), line.segment, images});
    }
  }

  const Place& place_;
  const Camera& lens_;
  const double noise_px_;
  Random& random_;
  ColmapModel model_;
  std::map<std::string, PointFeatures> features_;
  std::map<std::size_t, std::vector<ColmapPoint::Observation>> point_tracks_;
  std::map<std::size_t, std::vector<std::int64_t>> line_images_;
  LineTracks lines_;
};

}  // namespace

Status WriteMapping(const Place& place, const Camera& lens, double noise_px,
                    const std::string& directory, Random& random) {
  return Mapping(place, lens, noise_px, random).Write(directory);
}

}  // namespace maploc::testing
