#include "mapstore/importers/up_evidence.h"

#include <algorithm>
#include <cmath>

namespace maploc {
namespace {

// Of real outdoor sets 96 to 100% of the photos are brighter above, by 0.7 to 2.2 standard
// deviations in the mean, against 0.1 to 0.4 to the side (MEASUREMENTS.md). Four of five photos may
// agree by chance (19%), so that the mean must be significant too.
constexpr std::size_t kMinPhotos = 5;
constexpr double kMinShare = 0.8;
constexpr double kMinSlope = 0.3;
constexpr double kMinSigmas = 3.5;

// Whether the photos brighten along `way` (a unit vector in the image) and little across it.
bool BrightenAlong(std::span<const Eigen::Vector2d> brightening, const Eigen::Vector2d& way) {
  const auto count = static_cast<double>(brightening.size());
  double agree = 0.0;
  double squares = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& slope : brightening) {
    agree += slope.dot(way) > 0 ? 1.0 : 0.0;
    squares += std::pow(slope.dot(way), 2);
    mean += slope / count;
  }
  const double along = mean.dot(way);
  const double across = std::abs(mean.dot(Eigen::Vector2d(-way.y(), way.x())));
  const double variance = (squares - count * along * along) / (count - 1);
  return agree >= kMinShare * count && along >= kMinSlope && along >= 2.0 * across &&
         along * along * count >= kMinSigmas * kMinSigmas * variance;
}

}  // namespace

UpEvidence WeighBrightening(std::span<const Eigen::Vector2d> brightening) {
  if (brightening.size() < kMinPhotos) return UpEvidence::kNone;
  if (BrightenAlong(brightening, {0, -1})) return UpEvidence::kUpright;
  for (const Eigen::Vector2d& way :
       {Eigen::Vector2d(0, 1), Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0)}) {
    if (BrightenAlong(brightening, way)) return UpEvidence::kNotUpright;
  }
  return UpEvidence::kNone;
}

}  // namespace maploc
