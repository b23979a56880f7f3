// Which key frames look at the same things from different places: the pairs that matching and
// triangulation try.
#pragma once

#include <span>
#include <vector>

#include "mapstore/importers/tracks.h"

namespace maploc {

inline constexpr int kMaxNeighbours = 10;

// For each frame its neighbours, best first. With points: by the number of points shared, each
// weighted by its parallax. Without: by the distance of the centres, among frames that look in
// similar directions and do not stand in the same place. Symmetric: b is among a's whenever a is
// among b's (so a frame may have more than kMaxNeighbours).
std::vector<std::vector<int>> FindFrameNeighbours(std::span<const KeyFrame> frames,
                                                  std::span<const PointTrack> points);

}  // namespace maploc
