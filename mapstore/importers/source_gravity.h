// Gravity in a model's own frame: given, measured by the photos' sensors, or estimated from the
// photos. It is reported with its basis, compared with all other evidence, and refused where it is
// not determined. A wrong map gravity is the worst error, because every robot's correct gravity
// then contradicts it.
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

// Evidence of gravity, by photo.
struct GravityEvidence {
  std::vector<Eigen::Quaterniond> camera_from_source;
  std::vector<Eigen::Vector3d> measured_in_source;  // unit, down; of the photos that have it
  std::span<const FrameLines> lines;                // one per photo, or none
  std::span<const Eigen::Vector2d> brightening;     // alike
};

// Largest lean of a map: a robot's gravity is good to a degree and would contradict a larger one.
inline constexpr double kMaxGravityIntervalRad = 1.0 * std::numbers::pi / 180;

enum class GravityOrigin { kGiven, kMeasured, kEstimated };

struct SourceGravity {
  Eigen::Vector3d down_in_source = Eigen::Vector3d(0.0, 0.0, -1.0);  // unit
  double interval_rad = 0.0;  // the truth is nearer than this in 95 of 100 cases; 0: given
  GravityOrigin source = GravityOrigin::kGiven;
  std::string basis;    // the evidence in words; empty: given
  std::string warning;  // empty: no evidence against it
};

// The given direction (down, of any length but 0), else what sensors measured, else an estimate
// from the photos. Errors, each with the cure: the given direction is zero or not finite; none is
// given, and sign or tilt are not determined to one degree; the direction certainly contradicts the
// photos or their sensors, unless `force`.
Result<SourceGravity> FindSourceGravity(const GravityEvidence& evidence,
                                        const std::optional<Eigen::Vector3d>& given, bool force);

}  // namespace maploc
