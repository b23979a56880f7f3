// What the importers hand from stage to stage: key frames in the map's frame, and landmarks with
// the frames that saw them. Plain values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mapstore/features/detection_size.h"
#include "mapstore/geometry/camera.h"
#include "mapstore/geometry/line.h"
#include "mapstore/geometry/rigid3.h"

namespace maploc {

// A posed photo of the map. Frames are named by their index in one vector.
struct KeyFrame {
  std::int64_t image_id = 0;  // the source's
  std::string name;           // the source's, "map/0000.jpg"
  Camera camera;
  Rigid3 camera_from_map;

  Eigen::Vector3d CenterInMap() const {
    return -(camera_from_map.rotation.conjugate() * camera_from_map.translation);
  }
  // The photo's pixels to one of its features': 1, or more where it was reduced for the detectors.
  double FeaturePixel() const { return DetectionPixel({camera.width_px(), camera.height_px()}); }
  double FocalLengthInFeaturePixels() const { return camera.MeanFocalLengthPx() / FeaturePixel(); }
};

struct PointTrack {
  Eigen::Vector3d position_in_map = Eigen::Vector3d::Zero();
  std::vector<std::int32_t> frames;       // that saw it; ascending, unique
  std::vector<std::uint8_t> descriptors;  // rows of the map's kind, one an observation or fewer
};

struct LineTrackInMap {
  LineSegment3 segment_in_map;       // directed as LSD directs: dark on one side
  std::vector<std::int32_t> frames;  // that saw it; ascending, unique
  std::vector<std::uint8_t> descriptors;
};

}  // namespace maploc
