#include "client/robot/recorded_robot.h"

#include <algorithm>
#include <cmath>

#include "client/robot/metrics.h"
#include "mapstore/features/features.h"

namespace maploc {
namespace {

// Undoes v = 512 sqrt(x / |x|_1), and scales as OpenCV does: 512 x / |x|_2.
void PlainFromRootSift(std::uint8_t* row, int size) {
  std::vector<double> plain(size);
  double squares = 0.0;
  for (int i = 0; i < size; ++i) {
    plain[i] = static_cast<double>(row[i]) * row[i];
    squares += plain[i] * plain[i];
  }
  if (squares == 0.0) return;
  for (int i = 0; i < size; ++i) {
    row[i] = static_cast<std::uint8_t>(
        std::lround(std::min(255.0, 512.0 * plain[i] / std::sqrt(squares))));
  }
}

Status KindMismatch(const DescriptorKind& have, const DescriptorKind& want) {
  return FailedPrecondition("DESCRIPTOR_KIND_MISMATCH",
                            "the recording's descriptors are " + have.name + " (" +
                                std::to_string(have.bytes) + " bytes), but the map's are " +
                                want.name + " (" + std::to_string(want.bytes) +
                                "); use --images to extract the map's kind");
}

std::vector<ColmapImage> SortedByName(const ColmapModel& model) {
  std::vector<ColmapImage> images;
  for (const auto& [id, image] : model.images) images.push_back(image);
  std::ranges::sort(images, {}, &ColmapImage::name);
  return images;
}

}  // namespace

Result<PointFeatures> ConvertToKind(PointFeatures points, const DescriptorKind& kind) {
  Descriptors& descriptors = points.descriptors;
  if (descriptors.kind == kind) return points;
  if (points.keypoints_px.empty()) return PointFeatures{{}, {kind, {}}};
  if (descriptors.kind.name == "sift_root_u8" && kind.name == "sift_u8") {
    for (int i = 0; i < descriptors.size(); ++i) {
      PlainFromRootSift(descriptors.bytes.data() + static_cast<std::size_t>(i) * kind.bytes,
                        kind.bytes);
    }
  } else if (descriptors.kind.metric != kind.metric || descriptors.kind.bytes != kind.bytes ||
             kind.metric != DescriptorMetric::kHamming) {
    return KindMismatch(descriptors.kind, kind);
  }
  descriptors.kind = kind;
  return points;
}

Result<RecordedRobot> RecordedRobot::Open(const RecordingOptions& options, const MapInfo& map) {
  if (options.database.empty() && options.images.empty()) {
    return InvalidArgument("recording", "has neither --database nor --images, so no features");
  }
  MAPLOC_ASSIGN_OR_RETURN(GravitySource gravity, GravitySource::Create(options.gravity));
  RecordedRobot robot(options, map, std::move(gravity));
  MAPLOC_ASSIGN_OR_RETURN(robot.model_, ReadColmapModel(options.model_dir));
  robot.images_ = SortedByName(robot.model_);
  if (robot.images_.empty()) return InvalidFile(options.model_dir, "the model has no images");
  if (!options.database.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(robot.features_, ReadColmapDatabase(options.database));
    for (const ColmapImage& image : robot.images_) {
      if (robot.features_.contains(image.name)) continue;
      return InvalidFile(options.database, "has no features of image '" + image.name + "'");
    }
  }
  return robot;
}

Rigid3 RecordedRobot::CameraFromMap(int index) const {
  return MovePose(map_.map_from_source, images_[index].camera_from_source);
}

Rigid3 RecordedRobot::ReferenceMapFromBody(int index) const {
  return CameraFromMap(index).Inverse();
}

std::string RecordedRobot::ImagePath(int index) const {
  return options_.images.empty() ? "" : options_.images + "/" + images_[index].name;
}

std::optional<double> RecordedRobot::SceneDepth(int index) const {
  std::vector<double> depths;
  for (const std::int64_t id : images_[index].point_ids) {
    const auto point = model_.points.find(id);
    if (point == model_.points.end()) continue;
    depths.push_back((images_[index].camera_from_source * point->second.position_in_source).z() *
                     map_.map_from_source.scale);
  }
  return Quantile(std::move(depths), 0.5);
}

Status RecordedRobot::AddFeatures(int index, View& view) const {
  const bool wants_points = !map_.point_descriptor.name.empty();
  const bool wants_lines = !map_.line_descriptor.name.empty();
  if (wants_points && !options_.database.empty()) {
    const PointFeatures& stored = features_.at(images_[index].name).points;
    Result<PointFeatures> points = ConvertToKind(stored, map_.point_descriptor);
    if (!points.ok()) return points.status().WithContext(options_.database);
    view.points = *std::move(points);
  }
  const bool detect_points = wants_points && options_.database.empty();
  if (options_.images.empty() || (!detect_points && !wants_lines)) return Status::Ok();
  MAPLOC_ASSIGN_OR_RETURN(const GrayImage image, LoadGrayImage(ImagePath(index)));
  if (image.width_px != view.camera.width_px() || image.height_px != view.camera.height_px()) {
    return InvalidFile(ImagePath(index),
                       "its size is not that of the camera in " + options_.model_dir);
  }
  if (detect_points) {
    MAPLOC_ASSIGN_OR_RETURN(view.points, DetectPoints(image, map_.point_descriptor));
  }
  if (wants_lines) {
    MAPLOC_ASSIGN_OR_RETURN(view.lines, DetectLines(image));
  }
  return Status::Ok();
}

Result<Query> RecordedRobot::MakeQuery(int index) const {
  const ColmapImage& image = images_[index];
  View view{model_.cameras.at(image.camera_id), Rigid3{}, {}, {}};
  MAPLOC_RETURN_IF_ERROR(AddFeatures(index, view));
  Query query;
  query.request_id = image.name;
  query.map = map_.key.name;
  query.views.push_back(std::move(view));
  MAPLOC_ASSIGN_OR_RETURN(query.gravity, gravity_.For(image.name, CameraFromMap(index)));
  return query;
}

}  // namespace maploc
