// The features of a map's photos, detected on all cores.
#pragma once

#include <span>
#include <string>
#include <vector>

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

// The same for lines; a segment whose end points cannot be undistorted is left out.
Result<std::vector<FrameLines>> DetectPhotoLines(const std::string& images_directory,
                                                 std::span<const KeyFrame> frames,
                                                 const ProgressFn& progress);

}  // namespace maploc
