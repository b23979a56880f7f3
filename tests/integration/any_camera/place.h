// Made-up places of any size, anywhere: mapped through one lens and seen through another. What a
// robot sees is drawn as directions first, so that two lenses can be shown the very same.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "client/robot/appearance.h"
#include "mapstore/base/random.h"
#include "mapstore/base/status.h"
#include "mapstore/geometry/camera.h"
#include "mapstore/geometry/line.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/query.h"

namespace maploc::testing {

inline constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;

// The source's frame is the map's: gravity is (0, 0, -1), the unit a metre.
struct Place {
  struct Point {
    Eigen::Vector3d position;
    BinaryDescriptor descriptor;
  };
  struct Line {
    LineSegment3 segment;
    BinaryDescriptor descriptor;
  };
  double unit_m = 1.0;   // all lengths scale with it
  double range_m = 0.0;  // how far a landmark is seen
  std::vector<Point> points;
  std::vector<Line> lines;
  std::vector<Rigid3> camera_from_map;  // the mapping drive, in its order
  std::vector<Eigen::Vector3d> spots;   // where it stood
};

// Rooms in a row, with landmarks all around, 3 to 5 units from the middle; mapped from three spots
// in each, in 24 directions.
Place MakeRooms(double unit_m, const Eigen::Vector3d& origin, Random& random);
// A field of 80 x 40 units with poles up to 4 units high; mapped from 15 units above, straight
// down.
Place MakeField(Random& random);

// Writes DIRECTORY/model, /database.db and /lines.txt as seen through `lens` with `noise_px`:
// what maploc-map imports. Landmarks that fewer than two frames saw are left out.
Status WriteMapping(const Place& place, const Camera& lens, double noise_px,
                    const std::string& directory, Random& random);

struct SightingOptions {
  double reach_rad = 20 * kRadPerDeg;  // off the axis: as low as a 16:9 image is
  int most_points = 12;                // shown truly
  int most_lines = 12;
  double wrong_a_true = 3.0;     // features that look like what stands elsewhere
  double noise_rad = 1.0 / 500;  // about two axes across a ray
  double gravity_noise_rad = 0.5 * kRadPerDeg;
};

// What is seen from a place, as rays in a camera without a lens.
struct Sighting {
  struct Point {
    Eigen::Vector3d ray;
    BinaryDescriptor shown;
  };
  struct Line {
    Eigen::Vector3d start;
    Eigen::Vector3d end;
    BinaryDescriptor shown;
  };
  Rigid3 camera_from_map;
  Rigid3 camera_from_body;
  std::vector<Point> points;
  std::vector<Line> lines;
  Gravity gravity;  // in that camera

  Rigid3 BodyFromMap() const { return camera_from_body.Inverse() * camera_from_map; }
};

Sighting See(const Place& place, const Rigid3& camera_from_map, const SightingOptions& options,
             Random& random);

// The sighting through a lens on a robot; the lens is turned by `turn` from the camera without one.
// Features that the image does not hold are left out.
Query Through(const Sighting& sighting, const Camera& lens, const Eigen::Quaterniond& turn);
bool IsInImage(const Camera& lens, const Eigen::Vector2d& pixel);

// A camera that is held so that it measures this gravity, turned by `yaw_rad` about it.
Rigid3 CameraFromMap(const Eigen::Vector3d& centre, const Eigen::Vector3d& gravity_in_camera,
                     double yaw_rad);

}  // namespace maploc::testing
