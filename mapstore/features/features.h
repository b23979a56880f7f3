// Detects keypoints and line segments and computes their descriptors. The importer and the robot
// use the same functions, so that their descriptors are comparable. Deterministic; thread-safe.
// Positions are in pixels of the image as given; the centre of its first pixel is (0, 0). An image
// of more than kMaxDetectionPixels is reduced before detection (detection_size.h).
#pragma once

#include "mapstore/base/status.h"
#include "mapstore/features/detection_size.h"
#include "mapstore/features/image.h"
#include "mapstore/model/query.h"

namespace maploc {

struct PointDetectionOptions {
  int max_features = 5000;  // the strongest are kept
};

// Of line segments; the longest are kept.
inline constexpr int kMaxLines = 1000;
// In pixels of the reduced image if the image is reduced.
inline constexpr double kMinLineLengthPx = 20.0;

// The kind determines the detector: "orb" is ORB; "sift_root_u8" and "sift_u8" are SIFT.
// UNIMPLEMENTED for other kinds (the detector of "binaryN" is not known). SIFT returns a keypoint
// once for each of its orientations. Strongest first.
Result<PointFeatures> DetectPoints(const GrayImage& image, const DescriptorKind& kind,
                                   const PointDetectionOptions& options = {});

// LSD segments with LBD descriptors (kind "lbd"). Longest first.
Result<LineFeatures> DetectLines(const GrayImage& image);

}  // namespace maploc
