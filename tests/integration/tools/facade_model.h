// A facade of points, photographed (without pixels) by cameras on a walk along it, as COLMAP keeps
// it: text, binary, and the database with descriptors.
#pragma once

#include <fstream>
#include <map>
#include <string>

#include "mapstore/base/random.h"
#include "mapstore/formats/colmap_writer.h"

namespace maploc::testing {

struct FacadeModel {
  ColmapModel model;
  std::map<std::string, PointFeatures> features;
};

// What the camera of `image` sees of a point: a keypoint, a track's entry and a descriptor.
inline void See(FacadeModel& facade, ColmapImage& image, ColmapPoint& point) {
  const Camera& camera = facade.model.cameras.at(image.camera_id);
  const auto pixel = camera.Project(image.camera_from_source * point.position_in_source);
  if (!pixel || pixel->minCoeff() < 0 || pixel->x() > 999 || pixel->y() > 799) return;
  point.track.push_back({image.id, static_cast<std::int32_t>(image.keypoints_px.size())});
  image.keypoints_px.push_back(*pixel);
  image.point_ids.push_back(point.id);
  PointFeatures& features = facade.features[image.name];
  features.keypoints_px.push_back(pixel->cast<float>());
  features.descriptors.kind = *DescriptorKindFromName("binary4");
  for (int shift = 0; shift < 32; shift += 8) {
    features.descriptors.bytes.push_back(static_cast<std::uint8_t>(point.id * 2654435761 >> shift));
  }
}

// z up; cameras at y = -8 look along +y at a wall at y = 0.
inline FacadeModel MakeFacade(Random& random) {
  FacadeModel facade;
  facade.model.cameras.emplace(
      1, *Camera::Create(CameraModel::kPinhole, 1000, 800, {800, 800, 500, 400}));
  Eigen::Matrix3d camera_from_map;
  camera_from_map << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const Eigen::Quaterniond rotation(camera_from_map);
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d centre(0.8 * i, -8 + 0.1 * i, 1.5);
    const std::string name = "img" + std::to_string(i) + ".jpg";
    facade.model.images.emplace(
        i + 1, ColmapImage{i + 1, 1, name, {rotation, -(rotation * centre)}, {}, {}});
  }
  for (int id = 1; id <= 60; ++id) {
    ColmapPoint point{
        id, {random.Uniform(-1, 7), random.Uniform(-1, 1), random.Uniform(0, 3)}, 0.1, {}};
    for (auto& [image_id, image] : facade.model.images) See(facade, image, point);
    facade.model.points.emplace(id, point);
  }
  return facade;
}

// COLMAP's binary format, written here on its own so that the reader is not tested against itself.
class BinaryFile {
 public:
  explicit BinaryFile(const std::string& path) : file_(path, std::ios::binary) {}
  template <typename T>
  BinaryFile& operator<<(const T& value) {
    file_.write(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  void Text(const std::string& text) { file_.write(text.c_str(), text.size() + 1); }

 private:
  std::ofstream file_;
};

inline void WriteBinaryImages(const std::string& path, const ColmapModel& model) {
  BinaryFile file(path);
  file << std::uint64_t{model.images.size()};
  for (const auto& [id, image] : model.images) {
    const Rigid3& pose = image.camera_from_source;
    file << static_cast<std::uint32_t>(id) << pose.rotation.w() << pose.rotation.x()
         << pose.rotation.y() << pose.rotation.z();
    for (const double coordinate : pose.translation) file << coordinate;
    file << static_cast<std::uint32_t>(image.camera_id);
    file.Text(image.name);
    file << std::uint64_t{image.keypoints_px.size()};
    for (std::size_t i = 0; i < image.keypoints_px.size(); ++i) {
      file << image.keypoints_px[i].x() + 0.5 << image.keypoints_px[i].y() + 0.5
           << static_cast<std::int64_t>(image.point_ids[i]);
    }
  }
}

inline void WriteBinaryPoints(const std::string& path, const ColmapModel& model) {
  BinaryFile file(path);
  file << std::uint64_t{model.points.size()};
  for (const auto& [id, point] : model.points) {
    file << static_cast<std::uint64_t>(id);
    for (const double coordinate : point.position_in_source) file << coordinate;
    for (int channel = 0; channel < 3; ++channel) file << std::uint8_t{128};
    file << point.error_px << std::uint64_t{point.track.size()};
    for (const ColmapPoint::Observation& seen : point.track) {
      file << static_cast<std::uint32_t>(seen.image_id)
           << static_cast<std::uint32_t>(seen.keypoint);
    }
  }
}

// DIR/{cameras,images,points3D}.bin of a model whose cameras are pinholes. REQUIRES: DIR exists.
inline void WriteBinaryModel(const std::string& directory, const ColmapModel& model) {
  BinaryFile cameras(directory + "/cameras.bin");
  cameras << std::uint64_t{model.cameras.size()};
  for (const auto& [id, camera] : model.cameras) {
    cameras << static_cast<std::uint32_t>(id) << std::int32_t{1}
            << static_cast<std::uint64_t>(camera.width_px())
            << static_cast<std::uint64_t>(camera.height_px());
    for (const double param : ColmapCameraParams(camera)) cameras << param;
  }
  WriteBinaryImages(directory + "/images.bin", model);
  WriteBinaryPoints(directory + "/points3D.bin", model);
}

}  // namespace maploc::testing
