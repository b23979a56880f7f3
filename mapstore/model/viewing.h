// What the frames that a map was made from say about each landmark: from where it was seen. What
// cannot be seen from a pose is no evidence for it.
#pragma once

#include <span>

#include <Eigen/Core>

namespace maploc {

// From where a landmark was seen when the map was made: a cone about a direction, and distances.
struct ViewingRange {
  // Unit: mean direction from the landmark to the cameras that saw it; zero: not known.
  Eigen::Vector3f toward_cameras_in_map = Eigen::Vector3f::Zero();
  float max_angle_rad = 0;  // largest angle between that and the direction to one of the cameras
  float min_distance = 0;   // to the cameras, map units
  float max_distance = 0;

  bool IsKnown() const { return !toward_cameras_in_map.isZero(0); }
  bool operator==(const ViewingRange&) const = default;
};

// Of a landmark at `position_in_map` (a line: the middle of its segment) seen from these camera
// centres. A centre at the landmark, or farther than a float can say, is ignored; without any the
// range is not known. Directions that cancel out have no mean: then it is the first one, and the
// angle is pi.
ViewingRange MakeViewingRange(const Eigen::Vector3d& position_in_map,
                              std::span<const Eigen::Vector3d> camera_centers_in_map);

}  // namespace maploc
