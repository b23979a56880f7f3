// Keeps the two nearest landmarks of a query among the rows of a tile, behind Highway's run-time
// dispatch. Thread-safe.
#pragma once

#include <cstdint>

#include "mapstore/descriptors/neighbours.h"

namespace maploc::kernels {

// Inserts rows [0, count) into `nearest`, those in ascending order that can change it. Reads
// distances, which are aligned for any vector, up to the next multiple of kChunkRows
// (distance_kernels.h). `landmarks` has one a row, ascending.
void KeepNearest(const std::uint32_t* distances, const std::int32_t* landmarks, int count,
                 Neighbours& nearest);

}  // namespace maploc::kernels
