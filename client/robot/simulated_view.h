// What a camera sees of the made-up world: projection, simple hiding (walls, the heart of a tree's
// crown), noise, the season's changes, and clutter that belongs to nothing.
#pragma once

#include <vector>

#include "client/robot/simulated_world.h"
#include "mapstore/base/random.h"
#include "mapstore/geometry/camera.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/query.h"

namespace maploc {

struct SightOptions {
  double noise_px = 0.7;  // of keypoints, and of line ends across the line
  int clutter_points = 40;
  int clutter_lines = 8;
  bool look_alikes = true;  // Change::look_alike; off, what is seen shows its own descriptor
};

// The features, and the landmark behind each (index into the world's points or lines): what stands
// there, whatever it looks like; -1 for clutter.
struct Sight {
  PointFeatures points;  // kind "orb"
  LineFeatures lines;    // kind "lbd"
  std::vector<int> point_landmarks;
  std::vector<int> line_landmarks;
};

// 640 x 480, 80 degrees wide.
Camera SimulatedCamera();

Sight Look(const World& world, const Camera& camera, const Rigid3& camera_from_world,
           const Appearance& appearance, const SightOptions& options, Random& random);

}  // namespace maploc
