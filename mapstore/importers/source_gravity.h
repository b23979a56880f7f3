// Gravity in a model's own frame: given, measured by the photos' sensors, or estimated from the
// photos; told with what it rests on, compared with whatever else speaks of it, and refused where
// it is not determined. A map that leans is the worst kind of wrong map: every robot's honest
// gravity contradicts it.
#pragma once

#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "mapstore/base/status.h"
#include "mapstore/importers/photo_features.h"

namespace maploc {

// What speaks of gravity, by photo.
struct GravityEvidence {
  std::vector<Eigen::Quaterniond> camera_from_source;
  std::vector<Eigen::Vector3d> measured_in_source;  // unit, down; of the photos that have it
  std::span<const FrameLines> lines;                // one a photo, or none at all
  std::span<const Eigen::Vector2d> brightening;     // alike
};

// A map may lean by no more: a robot's gravity is good to a degree, and would contradict it.
inline constexpr double kMaxGravityIntervalRad = 1.0 * std::numbers::pi / 180;

enum class GravityOrigin { kGiven, kMeasured, kEstimated };

struct SourceGravity {
  Eigen::Vector3d down_in_source = Eigen::Vector3d(0.0, 0.0, -1.0);  // unit
  double interval_rad = 0.0;  // the truth is nearer than this in 95 of 100 cases; 0: given
  GravityOrigin source = GravityOrigin::kGiven;
  std::string basis;    // what it rests on, in words; empty: given
  std::string warning;  // empty: nothing speaks against it
};

// The given direction (any length but 0; down), else what sensors measured, else an estimate from
// the photos. Errors, each with the cure: given as zero or not finite; not given and its sign or
// its tilt is not determined to one degree; beyond doubt not what the photos or their sensors say,
// unless `force`.
Result<SourceGravity> FindSourceGravity(const GravityEvidence& evidence,
                                        const std::optional<Eigen::Vector3d>& given, bool force);

}  // namespace maploc
