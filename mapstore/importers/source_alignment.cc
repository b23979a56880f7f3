#include "mapstore/importers/source_alignment.h"

#include "mapstore/geometry/gravity.h"

namespace maploc {

Similarity3 AlignSource(const Eigen::Vector3d& gravity_in_source, double map_units_per_unit) {
  // CameraFromAligned turns (0, 0, -1) onto the given gravity, so its inverse is the turn wanted
  // here.
  return {map_units_per_unit, CameraFromAligned(gravity_in_source).conjugate(),
          Eigen::Vector3d::Zero()};
}

std::vector<KeyFrame> MakeKeyFrames(const ColmapModel& model, const Similarity3& map_from_source) {
  std::vector<KeyFrame> frames;
  for (const auto& [id, image] : model.images) {
    frames.push_back({id, image.name, model.cameras.at(image.camera_id),
                      MovePose(map_from_source, image.camera_from_source)});
  }
  return frames;
}

}  // namespace maploc
