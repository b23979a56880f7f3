#include "mapstore/formats/colmap_builder.h"

#include <cmath>
#include <utility>

#include "mapstore/formats/text_fields.h"

namespace maploc {
namespace {

template <typename Vector>
bool IsSane(const Vector& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kMaxColmapCoordinate;
}

Status CheckObservation(const ColmapModel& model, const ColmapPoint::Observation& observation) {
  const auto image = model.images.find(observation.image_id);
  if (image == model.images.end()) {
    return InvalidArgument(
        "track", "names image " + std::to_string(observation.image_id) + ", which does not exist");
  }
  const std::size_t keypoints = image->second.keypoints_px.size();
  if (observation.keypoint < 0 || static_cast<std::size_t>(observation.keypoint) >= keypoints) {
    return InvalidArgument("track", "names keypoint " + std::to_string(observation.keypoint) +
                                        " of image " + std::to_string(observation.image_id) +
                                        ", which has " + std::to_string(keypoints));
  }
  return Status::Ok();
}

}  // namespace

Result<Rigid3> MakeColmapPose(const std::array<double, 7>& v) {
  const Eigen::Quaterniond rotation(v[0], v[1], v[2], v[3]);
  const Eigen::Vector3d translation(v[4], v[5], v[6]);
  const double norm = rotation.norm();
  if (!(norm > 1e-6) || !(norm < 1e6)) {
    return InvalidArgument("rotation", "the quaternion's norm is 0 or not a number");
  }
  if (!IsSane(translation)) return InvalidArgument("translation", "is not finite or beyond 1e12");
  return Rigid3{rotation.normalized(), translation};
}

Status AddColmapCamera(ColmapModel& model, std::int64_t id, Result<Camera> camera) {
  // An unsupported model is an error only if an image uses the camera (AddColmapImage).
  if (!camera.ok() && camera.status().reason() != kUnsupportedCameraModel) return camera.status();
  if (id < 0) return InvalidArgument("camera id", "is negative");
  if (model.cameras.contains(id) || model.unsupported_cameras.contains(id)) {
    return InvalidArgument("camera id", std::to_string(id) + " stands twice");
  }
  if (camera.ok()) {
    model.cameras.emplace(id, *std::move(camera));
  } else {
    model.unsupported_cameras.emplace(id, camera.status());
  }
  return Status::Ok();
}

Status AddColmapImage(ColmapModel& model, ColmapImage image) {
  if (image.id < 0) return InvalidArgument("image id", "is negative");
  if (image.name.empty()) return InvalidArgument("image name", "is missing");
  if (const auto unsupported = model.unsupported_cameras.find(image.camera_id);
      unsupported != model.unsupported_cameras.end()) {
    return unsupported->second.WithContext("camera " + std::to_string(image.camera_id));
  }
  if (!model.cameras.contains(image.camera_id)) {
    return InvalidArgument("camera id",
                           std::to_string(image.camera_id) + " is not among the cameras");
  }
  for (std::size_t i = 0; i < image.keypoints_px.size(); ++i) {
    if (!IsSane(image.keypoints_px[i])) {
      return InvalidArgument("keypoint " + std::to_string(i), "is not finite or beyond 1e12");
    }
    if (image.point_ids[i] < -1) {
      return InvalidArgument("keypoint " + std::to_string(i), "its point id is negative");
    }
  }
  const std::int64_t id = image.id;
  if (!model.images.emplace(id, std::move(image)).second) {
    return InvalidArgument("image id", std::to_string(id) + " stands twice");
  }
  return Status::Ok();
}

Status AddColmapPoint(ColmapModel& model, ColmapPoint point) {
  if (point.id < 0) return InvalidArgument("point id", "is negative");
  if (!IsSane(point.position_in_source)) {
    return InvalidArgument("position", "is not finite or beyond 1e12");
  }
  for (const ColmapPoint::Observation& observation : point.track) {
    MAPLOC_RETURN_IF_ERROR(CheckObservation(model, observation));
  }
  const std::int64_t id = point.id;
  if (!model.points.emplace(id, std::move(point)).second) {
    return InvalidArgument("point id", std::to_string(id) + " stands twice");
  }
  return Status::Ok();
}

// A point's track decides which images see it. The ids in the images only have to exist.
Status CheckColmapPointIds(const ColmapModel& model,
                           const std::function<std::string(std::int64_t)>& where) {
  for (const auto& [id, image] : model.images) {
    for (std::size_t i = 0; i < image.point_ids.size(); ++i) {
      const std::int64_t point = image.point_ids[i];
      if (point == -1 || model.points.contains(point)) continue;
      return InvalidFile(where(id), "keypoint " + std::to_string(i) + ": point " +
                                        std::to_string(point) + " is not among the points");
    }
  }
  return Status::Ok();
}

}  // namespace maploc
