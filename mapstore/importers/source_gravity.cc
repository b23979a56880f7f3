#include "mapstore/importers/source_gravity.h"

#include <algorithm>

#include "mapstore/base/angles.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/importers/gravity_text.h"
#include "mapstore/importers/measured_gravity.h"
#include "mapstore/importers/photo_gravity.h"

namespace maploc {
namespace {

// Two that tell gravity and are further apart than this and twice the vaguer one's interval are not
// of one world: fronts lean by a degree or two, photographers by three.
constexpr double kBeyondDoubtRad = 5 * kRadPerDeg;
// Within the interval 19 of 20 are; half as far again is worth a word.
constexpr double kWorthAWord = 1.5;

// Someone who tells gravity, and how the message names them.
struct Teller {
  std::string name;
  Eigen::Vector3d down;
  double interval_rad = 0.0;
};

std::string Disagreement(const Teller& chosen, const Teller& other) {
  return chosen.name + " (" + DirectionText(chosen.down) + ") is " +
         Degrees(AngleBetween(chosen.down, other.down)) + " from what " + other.name + " say (" +
         DirectionText(other.down) + ", within " + Degrees(other.interval_rad) + ")";
}

// Refuses `chosen` where `other` contradicts it beyond doubt; else adds to the warning.
Status Compare(const Teller& chosen, const Teller& other, bool force, SourceGravity& gravity) {
  const double angle = AngleBetween(chosen.down, other.down);
  const double interval = std::max(chosen.interval_rad, other.interval_rad);
  if (angle > kBeyondDoubtRad + 2.0 * interval && !force) {
    return InvalidArgument("gravity", Disagreement(chosen, other) +
                                          "; check the sign and the order of the axes (down, in "
                                          "the model's frame) and give --gravity X,Y,Z, or add "
                                          "--force if it is right all the same");
  }
  if (angle > kWorthAWord * interval) {
    gravity.warning += (gravity.warning.empty() ? "" : "; ") + Disagreement(chosen, other);
  }
  return Status::Ok();
}

Result<SourceGravity> TakeGiven(const Eigen::Vector3d& given) {
  const double norm = given.norm();
  if (!given.allFinite() || !(norm > 1e-9) || !(norm < 1e9)) {
    return InvalidArgument("gravity",
                           "must be a finite direction other than 0,0,0 (down, in the "
                           "model's frame)");
  }
  return SourceGravity{given / norm, 0.0, GravityOrigin::kGiven, "", ""};
}

Result<SourceGravity> TakeMeasured(const DirectionFit& fit, std::size_t count) {
  SourceGravity gravity{fit.direction, Interval95Rad(fit), GravityOrigin::kMeasured,
                        "what was measured with " + std::to_string(count) + " photos", ""};
  if (gravity.interval_rad <= kMaxGravityIntervalRad) return gravity;
  return InvalidArgument("gravity",
                         "the database's measurements scatter, so that it is known to "
                         "within " +
                             Degrees(gravity.interval_rad) +
                             " only; give it as --gravity X,Y,Z (down, in the model's "
                             "frame)");
}

Result<SourceGravity> TakeEstimate(const PhotoGravity& photos) {
  if (photos.doubt.empty()) {
    return SourceGravity{photos.fit.direction, Interval95Rad(photos.fit), GravityOrigin::kEstimated,
                         photos.basis, ""};
  }
  std::string cure = "; give it as --gravity X,Y,Z (down, in the model's frame)";
  if (!photos.has_axis) {
    cure += ", for example the direction from the top to the foot of a house's edge";
  } else {
    cure += ": " + DirectionText(photos.fit.direction) +
            " if the photos are the right way up, the opposite if they are upside down";
  }
  return InvalidArgument("gravity", "the photos do not determine it: " + photos.doubt + cure);
}

}  // namespace

Result<SourceGravity> FindSourceGravity(const GravityEvidence& evidence,
                                        const std::optional<Eigen::Vector3d>& given, bool force) {
  const std::optional<DirectionFit> measured = FitMeasuredGravity(evidence.measured_in_source);
  // Also if gravity is given or measured: the photos may contradict it.
  const PhotoGravity photos = EstimateFromPhotos(evidence);
  Result<SourceGravity> chosen = given ? TakeGiven(*given)
                                 : measured
                                     ? TakeMeasured(*measured, evidence.measured_in_source.size())
                                     : TakeEstimate(photos);
  if (!chosen.ok()) return chosen;
  const Teller teller{given ? "the given gravity" : "the gravity measured with the photos",
                      chosen->down_in_source, chosen->interval_rad};
  if (given && measured) {
    MAPLOC_RETURN_IF_ERROR(Compare(teller,
                                   {"the photos' gravity sensors (pose_priors)",
                                    measured->direction, Interval95Rad(*measured)},
                                   force, *chosen));
  }
  if ((given || measured) && photos.is_witness) {
    MAPLOC_RETURN_IF_ERROR(Compare(
        teller, {photos.basis, photos.fit.direction, Interval95Rad(photos.fit)}, force, *chosen));
  }
  return chosen;
}

}  // namespace maploc
