// Keypoints and line segments with their descriptors, the same on both sides: the importer's photos
// and the robot's. Deterministic; thread-safe. Pixels: the image's own, centre of the first one at
// (0, 0). Images above kMaxDetectionPixels are reduced for the detectors (detection_size.h).
#pragma once

#include "mapstore/base/status.h"
#include "mapstore/features/detection_size.h"
#include "mapstore/features/image.h"
#include "mapstore/model/query.h"

namespace maploc {

struct PointDetectionOptions {
  int max_features = 5000;  // the strongest are kept
};

struct LineDetectionOptions {
  int max_features = 1000;      // the longest are kept
  double min_length_px = 20.0;  // of the reduced image, where it is reduced
};

// The kind says the detector: "orb" -> ORB; "sift_root_u8" and "sift_u8" -> SIFT. UNIMPLEMENTED for
// others (binaryN: unknown origin). Keypoints of equal position may repeat (one an orientation).
// Strongest first.
Result<PointFeatures> DetectPoints(const GrayImage& image, const DescriptorKind& kind,
                                   const PointDetectionOptions& options = {});

// LSD segments with LBD descriptors (kind "lbd"). Longest first.
Result<LineFeatures> DetectLines(const GrayImage& image, const LineDetectionOptions& options = {});

}  // namespace maploc
