// The features of a map's photos, detected on all cores.
#pragma once

#include <set>
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

// A photo whose file stops before the picture's end is left out: it has no features, and its name
// is told. Other errors name the photo: it is missing, cannot be decoded, or is not of its camera's
// size.
struct PhotoPoints {
  std::vector<PointFeatures> features;  // one entry a frame
  std::vector<std::string> truncated;   // names of photos left out
};
Result<PhotoPoints> DetectPhotoPoints(const std::string& images_directory,
                                      std::span<const KeyFrame> frames, const DescriptorKind& kind,
                                      const ProgressFn& progress);

// What photos show of lines, and of which way up they were taken. One entry a frame each.
struct PhotoLooks {
  std::vector<FrameLines> lines;
  // The way a photo grows brighter, over its width and its height, in its own standard deviations
  // of brightness. The sky is bright, and light comes from above.
  std::vector<Eigen::Vector2d> brightening;
  std::vector<std::string> truncated;  // names of photos left out: no lines, no brightening
};

// Left out and refused as above; a segment whose end points cannot be undistorted is left out.
Result<PhotoLooks> LookAtPhotos(const std::string& images_directory,
                                std::span<const KeyFrame> frames, const ProgressFn& progress);

// "2 of 25 photos are truncated and were left out: a.jpg, b.jpg; ..."; at most three are named.
// REQUIRES: `names` is not empty.
std::string DescribeTruncated(const std::set<std::string>& names, std::size_t photo_count);

}  // namespace maploc
