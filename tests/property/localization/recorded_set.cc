#include "tests/property/localization/recorded_set.h"

#include <algorithm>
#include <map>
#include <set>

#include "mapstore/formats/colmap.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/importers/landmark_views.h"
#include "mapstore/importers/shared_error.h"
#include "mapstore/importers/source_alignment.h"
#include "tests/support/resident_map.h"

namespace maploc::testing {
namespace {

using Features = std::map<std::string, ColmapFeatures>;

// Turns the source so that gravity is (0, 0, -1).
Similarity3 MapFromSource(const Eigen::Vector3d& gravity_in_source) {
  Similarity3 map_from_source;
  map_from_source.rotation =
      Eigen::Quaterniond::FromTwoVectors(gravity_in_source, kGravityInMap).normalized();
  return map_from_source;
}

// Key frames in the order of their names, which is the order of time.
std::vector<const ColmapImage*> OrderedImages(const ColmapModel& model) {
  std::vector<const ColmapImage*> images;
  for (const auto& [id, image] : model.images) images.push_back(&image);
  std::sort(images.begin(), images.end(),
            [](const ColmapImage* a, const ColmapImage* b) { return a->name < b->name; });
  return images;
}

// A stretch of key frames, [first, last).
struct Stretch {
  std::size_t first = 0;
  std::size_t last = 0;
};

std::vector<Stretch> CutPath(const std::vector<Eigen::Vector3d>& path, double length_m) {
  std::vector<double> walked(path.size(), 0.0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    walked[i] = walked[i - 1] + (path[i] - path[i - 1]).norm();
  }
  std::vector<Stretch> stretches;
  for (double begin = 0.0; stretches.empty() || stretches.back().last < path.size();
       begin += length_m / 2) {
    const auto first = std::lower_bound(walked.begin(), walked.end(), begin);
    const auto last = std::upper_bound(first, walked.end(), begin + length_m);
    const Stretch stretch{static_cast<std::size_t>(first - walked.begin()),
                          static_cast<std::size_t>(last - walked.begin())};
    if (stretch.first < stretch.last) stretches.push_back(stretch);
  }
  return stretches;
}

// Indices into `frames`, which ascend by image id; ascending, each once.
std::vector<std::int32_t> FramesThatSaw(const ColmapPoint& point,
                                        const std::vector<KeyFrame>& frames) {
  std::set<std::int32_t> seen_by;
  for (const ColmapPoint::Observation& seen : point.track) {
    const auto frame = std::lower_bound(
        frames.begin(), frames.end(), seen.image_id,
        [](const KeyFrame& candidate, std::int64_t id) { return candidate.image_id < id; });
    seen_by.insert(static_cast<std::int32_t>(frame - frames.begin()));
  }
  return {seen_by.begin(), seen_by.end()};
}

// All observations of the landmarks that the stretch saw, with all their descriptors.
std::shared_ptr<const Segment> MakeSegment(const ColmapModel& model, const Features& features,
                                           const std::vector<const ColmapImage*>& images,
                                           const std::vector<KeyFrame>& frames,
                                           const Stretch& stretch,
                                           const Similarity3& map_from_source, SegmentId id) {
  auto segment = std::make_shared<Segment>();
  segment->id = id;
  std::vector<LandmarkId>& ids = segment->points.ids;
  for (std::size_t i = stretch.first; i < stretch.last; ++i) {
    segment->path_in_map.push_back(map_from_source *
                                   images[i]->camera_from_source.Inverse().translation);
    for (const std::int64_t point : images[i]->point_ids) {
      if (point >= 0) ids.push_back(point);
    }
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (std::size_t landmark = 0; landmark < ids.size(); ++landmark) {
    const ColmapPoint& point = model.points.at(ids[landmark]);
    const Eigen::Vector3d position = map_from_source * point.position_in_source;
    segment->points.positions_in_map.push_back(position);
    const std::vector<std::int32_t> seen_by = FramesThatSaw(point, frames);
    segment->points.viewing.push_back(ViewingFromFrames(position, frames, seen_by));
    for (const ColmapPoint::Observation& seen : point.track) {
      const Descriptors& rows = features.at(model.images.at(seen.image_id).name).points.descriptors;
      const auto row = rows.row(seen.keypoint);
      segment->points.descriptors.kind = rows.kind;
      segment->points.descriptors.bytes.insert(segment->points.descriptors.bytes.end(), row.begin(),
                                               row.end());
      segment->points.descriptor_landmark.push_back(static_cast<std::int32_t>(landmark));
    }
  }
  return segment;
}

Result<std::shared_ptr<const MapSnapshot>> BuildMap(const ColmapModel& model,
                                                    const Features& features,
                                                    const Similarity3& map_from_source,
                                                    double segment_length_m) {
  const std::vector<const ColmapImage*> images = OrderedImages(model);
  std::vector<Eigen::Vector3d> path;
  for (const ColmapImage* image : images) {
    path.push_back(image->camera_from_source.Inverse().translation);
  }
  const std::vector<KeyFrame> frames = MakeKeyFrames(model, map_from_source);
  std::vector<MapSnapshot::Entry> entries;
  for (const Stretch& stretch : CutPath(path, segment_length_m)) {
    const auto id = static_cast<SegmentId>(entries.size());
    entries.push_back(
        {MakeSegment(model, features, images, frames, stretch, map_from_source, id), {}});
  }
  MapInfo info;
  info.key = {"recorded", 1};
  info.metric = true;
  info.map_from_source = map_from_source;
  info.shared_error_rad = SharedErrorRad(model);
  info.point_descriptor = entries.front().segment->points.descriptors.kind;
  return ResidentMap(info, entries);
}

Gravity MeasuredGravity(const Rigid3& camera_from_map, const GravitySource& source,
                        const std::map<std::string, Eigen::Vector3d>& csv, const std::string& name,
                        Random& random) {
  if (!csv.empty()) return {csv.at(name), source.sent_sigma_rad};
  const Eigen::Quaterniond noise =
      Eigen::AngleAxisd(random.Gaussian(source.noise_sigma_rad), Eigen::Vector3d::UnitX()) *
      Eigen::AngleAxisd(random.Gaussian(source.noise_sigma_rad), Eigen::Vector3d::UnitY());
  return {camera_from_map.rotation * (noise * kGravityInMap), source.sent_sigma_rad};
}

}  // namespace

Result<RecordedSet> LoadRecordedSet(const SetDescription& description, Random& random) {
  MAPLOC_ASSIGN_OR_RETURN(const ColmapModel model, ReadColmapModel(description.folder + "/map"));
  MAPLOC_ASSIGN_OR_RETURN(const Features features,
                          ReadColmapDatabase(description.folder + "/database.db"));
  std::map<std::string, Eigen::Vector3d> gravity;
  if (!description.gravity.csv.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(gravity, ReadGravityCsv(description.gravity.csv));
  }
  const Similarity3 map_from_source = MapFromSource(description.gravity_in_source);
  RecordedSet set;
  MAPLOC_ASSIGN_OR_RETURN(set.map,
                          BuildMap(model, features, map_from_source, description.segment_length_m));
  for (const std::string& session : description.sessions) {
    MAPLOC_ASSIGN_OR_RETURN(const ColmapModel recorded,
                            ReadColmapModel(description.folder + "/" + session));
    for (const ColmapImage* image : OrderedImages(recorded)) {
      const Rigid3 reference = MovePose(map_from_source, image->camera_from_source);
      RecordedQuery query{image->name, {}, reference};
      query.query.map = "recorded";
      query.query.views.push_back(
          View{recorded.cameras.at(image->camera_id), {}, features.at(image->name).points, {}});
      query.query.gravity =
          MeasuredGravity(reference, description.gravity, gravity, image->name, random);
      set.queries.push_back(std::move(query));
    }
  }
  return set;
}

}  // namespace maploc::testing
