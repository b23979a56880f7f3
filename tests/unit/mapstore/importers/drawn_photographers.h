// Made-up sets of photos for tests of gravity: how they are held, what lines they show and which
// side of them is bright. The world has z up; all is handed over in a source frame that leans, so
// that the truth is known without any of the importer's rules.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/importers/source_gravity.h"

namespace maploc::testing {

inline constexpr double kDegree = std::numbers::pi / 180;

// Where photos look, and how they are held; each is drawn within its range.
struct Holding {
  double yaw_range_deg = 360;
  double pitch_deg = 0;                 // upwards
  double pitch_range_deg = 20;          // of one photo from another
  std::vector<double> rolls_deg = {0};  // one is chosen for each photo
  double level_noise_deg = 2;
  double level_bias_deg = 0;  // of all photos
  int photos = 60;
};

struct PhotoSet {
  Eigen::Vector3d down_in_source;
  std::vector<Eigen::Quaterniond> camera_from_source;
  std::vector<FrameLines> lines;
  std::vector<Eigen::Vector2d> brightening;

  GravityEvidence Poses() const { return {camera_from_source, {}, {}, {}}; }
  GravityEvidence PosesAndPhotos() const { return {camera_from_source, {}, lines, brightening}; }
};

// camera_from_world of a camera that looks along yaw and pitch and is rolled about its axis.
inline Eigen::Matrix3d CameraFromWorld(double yaw, double pitch, double roll) {
  const Eigen::Vector3d ahead(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch),
                              std::sin(pitch));
  const Eigen::Vector3d right(std::sin(yaw), -std::cos(yaw), 0);
  const Eigen::Vector3d below = ahead.cross(right);
  Eigen::Matrix3d axes;
  axes.row(0) = std::cos(roll) * right + std::sin(roll) * below;
  axes.row(1) = -std::sin(roll) * right + std::cos(roll) * below;
  axes.row(2) = ahead;
  return axes;
}

// Segments of lines in one direction of the world, seen all over the picture with half a pixel of
// noise at a focal length of 1000.
inline void ShowLines(const Eigen::Matrix3d& camera_from_world, const Eigen::Vector3d& along,
                      int count, Random& random, FrameLines& shown) {
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d middle(random.Uniform(-3, 3), random.Uniform(-2, 2), 8);
    const Eigen::Vector3d half = random.Uniform(0.2, 0.8) * (camera_from_world * along);
    const Eigen::Vector3d start = middle - half;
    const Eigen::Vector3d end = middle + half;
    const auto noise = [&] {
      return Eigen::Vector2d(random.Gaussian(5e-4), random.Gaussian(5e-4));
    };
    shown.normalized.push_back(
        {start.head<2>() / start.z() + noise(), end.head<2>() / end.z() + noise()});
  }
}

inline FrameLines ShowScene(const Eigen::Matrix3d& camera_from_world, Random& random) {
  FrameLines shown;
  ShowLines(camera_from_world, {0, 0, 1}, 40, random, shown);  // edges of houses
  ShowLines(camera_from_world, {0, 1, 0}, 40, random, shown);  // their ledges
  for (int i = 0; i < 60; ++i) {                               // trees, people
    const Eigen::Vector3d along(random.Gaussian(), random.Gaussian(), random.Gaussian());
    ShowLines(camera_from_world, along.normalized(), 1, random, shown);
  }
  return shown;
}

inline PhotoSet TakePhotos(const Holding& holding, Random& random) {
  const Eigen::Quaterniond source_from_world = Eigen::Quaterniond(
      Eigen::Vector4d(random.Gaussian(), random.Gaussian(), random.Gaussian(), random.Gaussian())
          .normalized());
  PhotoSet set;
  set.down_in_source = source_from_world * Eigen::Vector3d(0, 0, -1);
  for (int i = 0; i < holding.photos; ++i) {
    const double yaw = random.Uniform(-0.5, 0.5) * holding.yaw_range_deg * kDegree;
    const double pitch =
        (holding.pitch_deg + random.Uniform(-0.5, 0.5) * holding.pitch_range_deg) * kDegree;
    const auto which = random.Below(static_cast<std::uint32_t>(holding.rolls_deg.size()));
    const double roll = (holding.rolls_deg[which] + holding.level_bias_deg +
                         random.Gaussian(holding.level_noise_deg)) *
                        kDegree;
    const Eigen::Matrix3d camera_from_world = CameraFromWorld(yaw, pitch, roll);
    set.camera_from_source.push_back(
        (Eigen::Quaterniond(camera_from_world) * source_from_world.conjugate()).normalized());
    set.lines.push_back(ShowScene(camera_from_world, random));
    const Eigen::Vector3d up = camera_from_world * Eigen::Vector3d(0, 0, 1);
    set.brightening.push_back(1.5 * up.head<2>() +
                              Eigen::Vector2d(random.Gaussian(0.5), random.Gaussian(0.5)));
  }
  return set;
}

}  // namespace maploc::testing
