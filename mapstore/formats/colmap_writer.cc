#include "mapstore/formats/colmap_writer.h"

#include <filesystem>
#include <fstream>

namespace maploc {
namespace {

constexpr double kHalfPixel = 0.5;

// Flushed before the check, because a full disk shows only when the buffer is written.
Status Finish(std::ofstream& file, const std::string& path) {
  file.flush();
  if (file) return Status::Ok();
  return Status(StatusCode::kInternal, "WRITE_FAILED", path + ": could not be written");
}

std::ofstream OpenText(const std::string& path) {
  std::ofstream file(path);
  // 17 digits give every double back exactly.
  file.precision(17);
  return file;
}

Status WriteCameras(const std::string& path, const ColmapModel& model) {
  std::ofstream file = OpenText(path);
  for (const auto& [id, camera] : model.cameras) {
    file << id << ' ' << CameraModelName(camera.model()) << ' ' << camera.width_px() << ' '
         << camera.height_px();
    for (const double param : ColmapCameraParams(camera)) file << ' ' << param;
    file << '\n';
  }
  return Finish(file, path);
}

Status WriteImages(const std::string& path, const ColmapModel& model) {
  std::ofstream file = OpenText(path);
  for (const auto& [id, image] : model.images) {
    const Eigen::Quaterniond& q = image.camera_from_source.rotation;
    file << id << ' ' << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' '
         << image.camera_from_source.translation.transpose() << ' ' << image.camera_id << ' '
         << image.name << '\n';
    for (std::size_t i = 0; i < image.keypoints_px.size(); ++i) {
      file << (i == 0 ? "" : " ") << image.keypoints_px[i].x() + kHalfPixel << ' '
           << image.keypoints_px[i].y() + kHalfPixel << ' ' << image.point_ids[i];
    }
    file << '\n';
  }
  return Finish(file, path);
}

Status WritePoints(const std::string& path, const ColmapModel& model) {
  std::ofstream file = OpenText(path);
  for (const auto& [id, point] : model.points) {
    // Any colour will do: the model has none.
    file << id << ' ' << point.position_in_source.transpose() << " 128 128 128 " << point.error_px;
    for (const ColmapPoint::Observation& observation : point.track) {
      file << ' ' << observation.image_id << ' ' << observation.keypoint;
    }
    file << '\n';
  }
  return Finish(file, path);
}

}  // namespace

// The principal point comes after the focal lengths: at 1 and 2, or at 2 and 3.
std::vector<double> ColmapCameraParams(const Camera& camera) {
  std::vector<double> params = camera.params();
  const bool one_focal_length = camera.model() == CameraModel::kSimplePinhole ||
                                camera.model() == CameraModel::kSimpleRadial ||
                                camera.model() == CameraModel::kRadial;
  const std::size_t cx = one_focal_length ? 1 : 2;
  params[cx] += kHalfPixel;
  params[cx + 1] += kHalfPixel;
  return params;
}

Status WriteColmapModel(const std::string& directory, const ColmapModel& model) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) {
    return InvalidArgument("directory", "'" + directory + "' cannot be made: " + error.message());
  }
  MAPLOC_RETURN_IF_ERROR(WriteCameras(directory + "/cameras.txt", model));
  MAPLOC_RETURN_IF_ERROR(WriteImages(directory + "/images.txt", model));
  return WritePoints(directory + "/points3D.txt", model);
}

}  // namespace maploc
