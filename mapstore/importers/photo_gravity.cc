#include "mapstore/importers/photo_gravity.h"

#include <optional>

#include "mapstore/base/angles.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/importers/camera_levels.h"
#include "mapstore/importers/gravity_text.h"
#include "mapstore/importers/up_evidence.h"
#include "mapstore/importers/vertical_lines.h"

namespace maploc {
namespace {

// One in ten thousand sound sets: then the lines are not vertical, or the photos not level.
constexpr double kMaxDistance2 = 18.42;
// An estimate that is vaguer says nothing about a direction from elsewhere.
constexpr double kMaxWitnessInterval = 15 * kRadPerDeg;

// Combines the levels with the scene's vertical lines. Returns whether there are any.
bool AddLines(const GravityEvidence& evidence, const CameraLevels& levels, PhotoGravity& gravity) {
  if (evidence.lines.empty()) return false;
  const std::optional<VerticalLines> verticals =
      FindVerticalLines(evidence.camera_from_source, evidence.lines, levels);
  if (!verticals) return false;
  if (Distance2(verticals->down_in_source, levels.down_in_source) > kMaxDistance2) {
    gravity.doubt = "the scene's nearly vertical lines lean by " +
                    Degrees(AngleBetween(verticals->down_in_source.direction,
                                         levels.down_in_source.direction)) +
                    " from what the photos' levels say";
    return true;
  }
  gravity.fit = Combine(verticals->down_in_source, levels.down_in_source);
  gravity.basis += " and " + std::to_string(verticals->segments) + " vertical edges in " +
                   std::to_string(verticals->photos) + " of them";
  return true;
}

std::string DoubtTilt(const GravityEvidence& evidence, const CameraLevels& levels,
                      const PhotoGravity& gravity) {
  std::string doubt = DescribeHolding(evidence.camera_from_source, levels) + "; the estimate " +
                      DirectionText(gravity.fit.direction) + " is known to within " +
                      Degrees(Interval95Rad(gravity.fit)) + " only";
  if (evidence.lines.empty()) {
    doubt += " (pass the photos with --images, so that vertical edges can be used)";
  }
  return doubt;
}

std::string DoubtSign(UpEvidence up, bool has_photos) {
  switch (up) {
    case UpEvidence::kUpright:
      return "";
    case UpEvidence::kNotUpright:
      return "the photos' bright side is not their upper one: they seem to be taken upside down or "
             "on their side";
    case UpEvidence::kNone:
      break;
  }
  return has_photos
             ? "no bright sky or light shows which way up the photos were taken"
             : "camera poses alone cannot show whether all photos were upside down; pass the "
               "photos with --images";
}

}  // namespace

PhotoGravity EstimateFromPhotos(const GravityEvidence& evidence) {
  PhotoGravity gravity;
  const std::size_t count = evidence.camera_from_source.size();
  if (count < kMinLevelPhotos) {
    gravity.doubt = "there are " + std::to_string(count) + " photos, and it takes " +
                    std::to_string(kMinLevelPhotos);
    return gravity;
  }
  const CameraLevels levels = FitCameraLevels(evidence.camera_from_source);
  gravity.fit = levels.down_in_source;
  gravity.basis = "the levels of " + std::to_string(count) + " photos";
  if (!levels.AgreeOnSign()) {
    gravity.doubt = DescribeHolding(evidence.camera_from_source, levels);
    return gravity;
  }
  const bool has_lines = AddLines(evidence, levels, gravity);
  if (!gravity.doubt.empty()) return gravity;
  const UpEvidence up = WeighBrightening(evidence.brightening);
  const bool levels_suffice =
      levels.looks_around && Interval95Rad(levels.down_in_source) < kMaxWitnessInterval;
  // Photos in one direction scatter about as much by the hand as by where they look, so that the
  // fit can take the one for the other, and be sure of a wrong tilt.
  gravity.is_witness = up == UpEvidence::kUpright && has_lines
                           ? Interval95Rad(gravity.fit) < kMaxWitnessInterval
                           : up != UpEvidence::kNotUpright && levels_suffice;
  gravity.has_axis = Interval95Rad(gravity.fit) <= kMaxGravityIntervalRad;
  gravity.doubt = gravity.has_axis ? DoubtSign(up, !evidence.brightening.empty())
                                   : DoubtTilt(evidence, levels, gravity);
  return gravity;
}

}  // namespace maploc
