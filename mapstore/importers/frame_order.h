// In which order photos were taken.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapstore/importers/tracks.h"

namespace maploc {

// Along the path on which the frames were recorded: by name, numbers in names by their value
// ("img2" before "img10"), as recorders name them. Nothing for unordered photos: where that path is
// more than twice as long as OrderByNearness.
std::optional<std::vector<int>> RecordedOrder(std::span<const KeyFrame> frames);

// `subset` from the frame farthest from its middle, always to the nearest one left.
std::vector<int> OrderByNearness(std::span<const KeyFrame> frames, const std::vector<int>& subset);

// Length of the path through the frames' centres.
double PathLength(std::span<const KeyFrame> frames, const std::vector<int>& order);

}  // namespace maploc
