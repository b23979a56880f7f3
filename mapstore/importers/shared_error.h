// By how much do the map's own frames disagree with its landmarks?
#pragma once

#include "mapstore/formats/colmap.h"

namespace maploc {

// Landmarks that were triangulated from the same photos share the pose errors of these photos.
// However many there are, every pose that is found with them has the same error. The map itself
// shows it: when a frame's pose is refined against the landmarks that it saw, the pose moves by the
// frame's own error, except for the 1 / m of it that is already in a landmark of m frames. The
// landmarks' images move with it. The error of such a landmark is the mean of the errors of its m
// frames. Returned is the root mean square of these means over all frames, an angle (rad) about
// each image axis. 0 (unknown) where no frame sees kLeastObservations points. Deterministic;
// thread-safe.
double SharedErrorRad(const ColmapModel& model);

inline constexpr int kLeastObservations = 15;

}  // namespace maploc
