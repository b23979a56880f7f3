#include "client/robot/simulated_map.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include "client/robot/simulated_robot.h"
#include "mapstore/formats/colmap_writer.h"
#include "mapstore/formats/line_tracks.h"

namespace maploc {
namespace {

constexpr std::int64_t kCameraId = 1;
constexpr double kSpacingM = 1.5;       // between key frames
constexpr int kMinTrack = 3;            // key frames that must have seen a landmark
constexpr int kMaxLineDescriptors = 6;  // of a line, spread over its track

struct LineObservation {
  std::int64_t image_id;
  BinaryDescriptor descriptor;
};

class MappingDrive {
 public:
  // The world is made of its seed itself (simulated_world.cc); the next one gives the drive a
  // generator of its own.
  MappingDrive(const World& world, const MappingOptions& options)
      : world_(world), options_(options), random_(world.options.seed + 1) {
    model_.cameras.emplace(kCameraId, SimulatedCamera());
  }

  void Drive() {
    const int frames = static_cast<int>(world_.LaneLength() / kSpacingM);
    for (int i = 0; i < frames; ++i) {
      AddKeyFrame(i, options_.start_m + i * world_.LaneLength() / frames);
    }
    AddPoints();
    AddLines();
  }

  Result<MappingSummary> Write(const std::string& directory) const {
    MAPLOC_RETURN_IF_ERROR(WriteColmapModel(directory + "/model", model_));
    MAPLOC_RETURN_IF_ERROR(WriteColmapDatabase(directory + "/database.db", model_, features_));
    MAPLOC_RETURN_IF_ERROR(WriteLineTracks(directory + "/lines.txt", line_tracks_));
    return MappingSummary{static_cast<int>(model_.images.size()),
                          static_cast<int>(model_.points.size()),
                          static_cast<int>(line_tracks_.tracks.size())};
  }

 private:
  void AddKeyFrame(int index, double along_m) {
    ColmapImage image;
    image.id = index + 1;
    image.camera_id = kCameraId;
    char name[32];
    std::snprintf(name, sizeof(name), "map/%04d", index);
    image.name = name;
    image.camera_from_source =
        SimulatedCameraFromBody() * WorldFromBody(world_, along_m, 0.0, 0.0, 0.0, 0.0).Inverse();
    Sight sight = Look(world_, model_.cameras.at(kCameraId), image.camera_from_source,
                       AppearanceOf(Season::kSummer), options_.sight, random_);
    for (std::size_t i = 0; i < sight.point_landmarks.size(); ++i) {
      image.keypoints_px.push_back(sight.points.keypoints_px[i].cast<double>());
      // COLMAP's mark for a keypoint without a point; AddPoints gives those of long tracks theirs.
      image.point_ids.push_back(-1);
      point_tracks_[sight.point_landmarks[i]].push_back({image.id, static_cast<std::int32_t>(i)});
    }
    for (std::size_t i = 0; i < sight.line_landmarks.size(); ++i) {
      LineObservation observation{image.id, {}};
      std::ranges::copy(sight.lines.descriptors.row(static_cast<int>(i)),
                        observation.descriptor.begin());
      line_observations_[sight.line_landmarks[i]].push_back(observation);
    }
    features_.emplace(image.name, std::move(sight.points));
    model_.images.emplace(image.id, std::move(image));
  }

  void AddPoints() {
    for (const auto& [landmark, track] : point_tracks_) {
      if (static_cast<int>(track.size()) < kMinTrack) continue;
      ColmapPoint point;
      point.id = landmark + 1;
      point.position_in_source =
          world_.points[landmark].position + Noise(options_.position_noise_m);
      point.error_px = options_.sight.noise_px;
      point.track = track;
      for (const ColmapPoint::Observation& seen : track) {
        model_.images.at(seen.image_id).point_ids[seen.keypoint] = point.id;
      }
      model_.points.emplace(point.id, std::move(point));
    }
  }

  void AddLines() {
    line_tracks_.descriptors.kind = *DescriptorKindFromName("lbd");
    for (const auto& [landmark, seen] : line_observations_) {
      if (static_cast<int>(seen.size()) < kMinTrack) continue;
      const LineSegment3& segment = world_.lines[landmark].segment;
      const double sigma_m = options_.line_noise_m;
      LineTrack track{landmark, {segment.start + Noise(sigma_m), segment.end + Noise(sigma_m)}, {}};
      for (const LineObservation& observation : seen)
        track.image_ids.push_back(observation.image_id);
      const int kept = std::min(static_cast<int>(seen.size()), kMaxLineDescriptors);
      for (int i = 0; i < kept; ++i) {
        const BinaryDescriptor& row = seen[i * seen.size() / kept].descriptor;
        auto& bytes = line_tracks_.descriptors.bytes;
        bytes.insert(bytes.end(), row.begin(), row.end());
        line_tracks_.descriptor_track.push_back(
            static_cast<std::int32_t>(line_tracks_.tracks.size()));
      }
      line_tracks_.tracks.push_back(std::move(track));
    }
  }

  Eigen::Vector3d Noise(double sigma_m) {
    return {random_.Gaussian(sigma_m), random_.Gaussian(sigma_m), random_.Gaussian(sigma_m)};
  }

  const World& world_;
  const MappingOptions& options_;
  Random random_;
  ColmapModel model_;
  // Ordered, so that noise is drawn in one order and a seed gives one map.
  std::map<std::string, PointFeatures> features_;
  std::map<int, std::vector<ColmapPoint::Observation>> point_tracks_;
  std::map<int, std::vector<LineObservation>> line_observations_;
  LineTracks line_tracks_;
};

}  // namespace

Result<MappingSummary> WriteMappingDrive(const World& world, const MappingOptions& options,
                                         const std::string& directory) {
  MappingDrive drive(world, options);
  drive.Drive();
  return drive.Write(directory);
}

}  // namespace maploc
