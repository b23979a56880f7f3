// Gravity from the way cameras are held.
//
// A camera held upright has a level x axis: x . g = sin(b + e). Here e is how far the photo is off
// level, and b is common to all photos (a tilted mount, a person's habit). g and b are fitted
// robustly. Photos in many directions separate b from an error of g. Photos in one direction do
// not: they do not determine g's tilt in that direction, and the covariance says so. The habit of
// holding a camera about level bounds this tilt to some tens of degrees.
//
// The sign comes from the y axes. It is a habit too: camera poses alone cannot prove it, because
// photos taken upside down have the same poses in a scene turned over. Evidence of the sign comes
// from the photos themselves (up_evidence.h).
#pragma once

#include <span>
#include <string>

#include <Eigen/Geometry>

#include "mapstore/importers/direction_fit.h"

namespace maploc {

// With fewer photos no habit can be assumed.
inline constexpr int kMinLevelPhotos = 5;

struct CameraLevels {
  DirectionFit down_in_source;
  double upright_share = 0.0;  // of the photos whose y axis points down within 70 degrees
  // The x axes differ, which distinguishes photos held level from photos all held on their side.
  bool looks_around = false;
  // The y axes of all photos but a few agree that they are upright.
  bool AgreeOnSign() const { return upright_share >= 0.9; }
};

// REQUIRES: at least kMinLevelPhotos.
CameraLevels FitCameraLevels(std::span<const Eigen::Quaterniond> camera_from_source);

// In words, why photos that were held like this do not determine gravity.
std::string DescribeHolding(std::span<const Eigen::Quaterniond> camera_from_source,
                            const CameraLevels& levels);

}  // namespace maploc
