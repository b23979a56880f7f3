// Which way up photos were taken, from what they show: outdoors the sky is the bright side, indoors
// the light comes from above. Poses alone cannot show it: if all photos were taken upside down, or
// all on their side, their poses are the same as upright ones in a scene turned over.
#pragma once

#include <span>

#include <Eigen/Core>

namespace maploc {

enum class UpEvidence {
  kNone,        // too few photos, no bright side, or not the same one
  kUpright,     // the bright side is the photos' upper one
  kNotUpright,  // it is their lower one, or one beside
};

// From each photo's brightening (photo_features.h).
UpEvidence WeighBrightening(std::span<const Eigen::Vector2d> brightening);

}  // namespace maploc
