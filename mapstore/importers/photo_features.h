// The features of a map's photos, detected on all cores.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mapstore/base/status.h"
#include "mapstore/features/features.h"
#include "mapstore/importers/line_triangulator.h"
#include "mapstore/importers/parallel.h"
#include "mapstore/importers/tracks.h"

namespace maploc {

// One entry a frame. Errors name the photo: it is missing, cannot be decoded, or is not of its
// camera's size.
Result<std::vector<PointFeatures>> DetectPhotoPoints(const std::string& images_directory,
                                                     std::span<const KeyFrame> frames,
                                                     const DescriptorKind& kind,
                                                     const ProgressFn& progress);

// What photos show of lines, and of which way up they were taken. One entry a frame each.
struct PhotoLooks {
  std::vector<FrameLines> lines;
  // The way a photo grows brighter, over its width and its height, in its own standard deviations
  // of brightness. The sky is bright, and light comes from above.
  std::vector<Eigen::Vector2d> brightening;
};

// Errors as above; a segment whose end points cannot be undistorted is left out.
Result<PhotoLooks> LookAtPhotos(const std::string& images_directory,
                                std::span<const KeyFrame> frames, const ProgressFn& progress);

}  // namespace maploc
