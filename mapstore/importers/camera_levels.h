// What the way cameras are held says about gravity.
//
// A camera held upright has its x axis level: x . g = sin(b + e), where e is how far the photo is
// off level and b what all photos share (a mount that leans, a hand's habit). Fitted robustly for g
// and b. Photos that look around tell b from a leaning g; photos that all look one way do not, and
// say nothing about g's tilt towards the scene: the covariance has it so. A habit, people look
// about level, bounds what is left open to some tens of degrees.
//
// The sign is that of the y axes. It is a habit too, and cannot be told from poses alone: photos
// taken upside down look the same. Who needs the sign asks the photos (up_evidence.h).
#pragma once

#include <span>
#include <string>

#include <Eigen/Geometry>

#include "mapstore/importers/direction_fit.h"

namespace maploc {

// Fewer photos prove no habit.
inline constexpr int kMinLevelPhotos = 5;

struct CameraLevels {
  DirectionFit down_in_source;
  double upright_share = 0.0;  // of the photos whose y axis points down within 70 degrees
  // The x axes differ, so that photos held level are told from photos all held on their side.
  bool looks_around = false;
  // The y axes agree that the photos are upright, but for a few.
  bool AgreeOnSign() const { return upright_share >= 0.9; }
};

// REQUIRES: at least kMinLevelPhotos.
CameraLevels FitCameraLevels(std::span<const Eigen::Quaterniond> camera_from_source);

// In words, why photos that were held like this do not determine gravity.
std::string DescribeHolding(std::span<const Eigen::Quaterniond> camera_from_source,
                            const CameraLevels& levels);

}  // namespace maploc
