// By how much do the map's own frames disagree with its landmarks?
#pragma once

#include "mapstore/formats/colmap.h"

namespace maploc {

// Landmarks that were triangulated from the same photos share these photos' pose errors, and share
// them with every pose that is found by them, however many they are. It shows in the map itself: a
// frame whose pose is refined against the landmarks that it saw moves, and its landmarks' images
// with it: by the frame's own error, but for the 1 / m of it that is in a landmark of m frames
// already. Such a landmark has the mean of m frames' errors. Told is the root mean square of these
// means over all frames, an angle (rad) about each image axis. 0 where no frame sees
// kLeastObservations points: not known. Deterministic; thread-safe.
double SharedErrorRad(const ColmapModel& model);

inline constexpr int kLeastObservations = 15;

}  // namespace maploc
