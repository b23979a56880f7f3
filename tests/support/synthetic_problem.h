// Made-up pose problems with a known answer, after the paper's synthetic protocol (section V-A): a
// cube [-1, 1]^3 seen from 3 to 5 metres, or a corridor seen from inside. Everything comes from the
// generator that is handed in.
#pragma once

#include <cstdint>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/matches.h"

namespace maploc::testing {

enum class Scene { kCube, kCorridor };

// What a wrong match sees: some pixel of the image, each as probable; or, as the paper makes them,
// the image of another wrong match's landmark (one random cycle through all wrong matches of a
// kind). The second crowd where the scene is, and agree by chance more often.
enum class Outliers { kRandomPixels, kWrongAssociations };

struct SyntheticOptions {
  Scene scene = Scene::kCube;
  Outliers outliers = Outliers::kRandomPixels;
  int point_inliers = 50;
  int point_outliers = 0;
  int line_inliers = 0;
  int line_outliers = 0;
  double vertical_line_share = 0.0;  // of all lines; the others have any direction
  double noise_px = 1.0;             // of keypoints and lines' end points, each coordinate
  double gravity_noise_rad = 0.0;    // N(0, this) about each horizontal axis
  double gravity_sigma_rad = 0.0;    // stated in the problem
  double focal_length_px = 500.0;
  int image_width_px = 640;
  int image_height_px = 480;
};

struct SyntheticProblem {
  PoseProblem problem;
  Rigid3 camera_from_map;  // the truth
  std::vector<std::uint8_t> point_is_inlier;
  std::vector<std::uint8_t> line_is_inlier;
};

// Features in random order (ordered inliers would flatter a sampler).
SyntheticProblem MakeSyntheticProblem(const SyntheticOptions& options, Random& random);

// The same problem, the map and the camera in it moved by `by`.
SyntheticProblem MovedBy(const Eigen::Vector3d& by, SyntheticProblem problem);

// A camera of the scene: within it or around it, level within 30 degrees, in any direction.
Rigid3 MakeCameraFromMap(Scene scene, Random& random);

// Uniform on the unit sphere.
Eigen::Vector3d RandomDirection(Random& random);
Eigen::Quaterniond RandomRotation(Random& random);

// Gravity in the camera under the true pose, turned by N(0, sigma) about the two horizontal axes.
Eigen::Vector3d NoisyGravityInCamera(const Rigid3& camera_from_map, double sigma_rad,
                                     Random& random);

struct PoseError {
  double rotation_rad = 0.0;
  double position = 0.0;  // distance of the camera's centres, in the map's unit
};
PoseError ComparePoses(const Rigid3& camera_from_map, const Rigid3& truth);

}  // namespace maploc::testing
