#include "client/robot/recorded_robot.h"

#include <algorithm>
#include <cmath>

#include "client/robot/metrics.h"
#include "client/robot/strongest.h"
#include "mapstore/features/features.h"
#include "mapstore/features/photo_header.h"

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

bool IsPlainFromRoot(const DescriptorKind& have, const DescriptorKind& want) {
  return have.name == "sift_root_u8" && want.name == "sift_u8";
}

// Cameras number their photos, so that this is the order of the drive; a prior needs it
// (PriorMode).
std::vector<ColmapImage> SortedByName(const ColmapModel& model) {
  std::vector<ColmapImage> images;
  for (const auto& [id, image] : model.images) images.push_back(image);
  std::ranges::sort(images, {}, &ColmapImage::name);
  return images;
}

}  // namespace

Status CheckConvertible(const DescriptorKind& have, const DescriptorKind& want) {
  // COLMAP's database does not name its binary kinds: of equal length they are taken for the map's.
  const bool same_bits = have.metric == want.metric && have.bytes == want.bytes &&
                         want.metric == DescriptorMetric::kHamming;
  const bool convertible = have == want || IsPlainFromRoot(have, want) || same_bits;
  return convertible ? Status::Ok() : KindMismatch(have, want);
}

Result<PointFeatures> ConvertToKind(PointFeatures points, const DescriptorKind& kind) {
  Descriptors& descriptors = points.descriptors;
  if (descriptors.kind == kind) return points;
  // An image in which nothing was detected may have no kind.
  if (points.keypoints_px.empty()) return PointFeatures{{}, {kind, {}}};
  MAPLOC_RETURN_IF_ERROR(CheckConvertible(descriptors.kind, kind));
  if (IsPlainFromRoot(descriptors.kind, kind)) {
    for (int i = 0; i < descriptors.size(); ++i) {
      PlainFromRootSift(descriptors.bytes.data() + static_cast<std::size_t>(i) * kind.bytes,
                        kind.bytes);
    }
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
  }
  MAPLOC_RETURN_IF_ERROR(robot.CheckInputs());
  return robot;
}

std::vector<std::string> RecordedRobot::ImageNames() const {
  std::vector<std::string> names;
  for (const ColmapImage& image : images_) names.push_back(image.name);
  return names;
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
    // In the map's unit.
    depths.push_back((images_[index].camera_from_source * point->second.position_in_source).z() *
                     map_.map_from_source.scale);
  }
  return Quantile(std::move(depths), 0.5);
}

Status RecordedRobot::AddFeatures(int index, View& view) const {
  if (ReadsDatabase()) {
    const ColmapFeatures& stored = features_.at(images_[index].name);
    Result<PointFeatures> points = ConvertToKind(
        Strongest(stored.points, stored.scales_px, options_.max_features.value_or(kMaxSentPoints)),
        map_.point_descriptor);
    if (!points.ok()) return points.status().WithContext(options_.database);
    view.points = *std::move(points);
  }
  if (!ReadsPhotos()) return Status::Ok();
  MAPLOC_ASSIGN_OR_RETURN(const GrayImage image, LoadGrayImage(ImagePath(index)));
  // Once more, on the decoded photo: CheckPhotos knows the size of JPEG and PNG alone.
  MAPLOC_RETURN_IF_ERROR(CheckPhotoSize(ImagePath(index), image.width_px, image.height_px,
                                        view.camera, options_.model_dir));
  if (DetectsPoints()) {
    PointDetectionOptions detection;
    detection.max_features = options_.max_features.value_or(detection.max_features);
    MAPLOC_ASSIGN_OR_RETURN(view.points, DetectPoints(image, map_.point_descriptor, detection));
  }
  if (WantsLines()) {
    MAPLOC_ASSIGN_OR_RETURN(view.lines, DetectLines(image));
  }
  return Status::Ok();
}

Result<Query> RecordedRobot::MakeQuery(int index) const {
  const ColmapImage& image = images_[index];
  View view{model_.cameras.at(image.camera_id), Rigid3{}, {}, {}};
  MAPLOC_RETURN_IF_ERROR(AddFeatures(index, view));
  Query query;
  // So that a line of the server's log leads to the photo.
  query.request_id = image.name;
  query.map = map_.key.name;
  query.views.push_back(std::move(view));
  if (!options_.gravity.none) {
    MAPLOC_ASSIGN_OR_RETURN(query.gravity, gravity_.For(image.name, CameraFromMap(index)));
  }
  return query;
}

}  // namespace maploc
