#include "mapstore/importers/source_alignment.h"

#include <numbers>

namespace maploc {

Result<SourceGravity> FindSourceGravity(const ColmapModel& model,
                                        const std::optional<Eigen::Vector3d>& given) {
  if (given) {
    const double norm = given->norm();
    if (!given->allFinite() || !(norm > 1e-9) || !(norm < 1e9)) {
      return InvalidArgument("gravity",
                             "must be a finite direction other than 0,0,0 (down, in the "
                             "model's frame)");
    }
    return SourceGravity{{*given / norm, 0.0}, true};
  }
  std::vector<Rigid3> poses;
  for (const auto& [id, image] : model.images) poses.push_back(image.camera_from_source);
  const GravityEstimate estimate = EstimateGravityFromPoses(poses);
  if (!(estimate.spread_rad < std::numbers::pi / 2)) {
    return InvalidArgument("gravity",
                           "the photos' poses do not determine it; give it as --gravity "
                           "X,Y,Z (down, in the model's frame)");
  }
  return SourceGravity{estimate, false};
}

Similarity3 AlignSource(const Eigen::Vector3d& gravity_in_source, double map_units_per_unit) {
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
