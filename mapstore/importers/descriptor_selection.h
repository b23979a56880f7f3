// How many descriptors a landmark keeps.
#pragma once

#include <cstdint>
#include <vector>

#include "mapstore/model/descriptor.h"

namespace maploc {

// At most max_rows of the rows in `bytes`, the most different ones: first the one nearest to all
// others (the smallest sum of distances), then always the one farthest from those kept. In their
// original order; all of them when there are no more than max_rows. REQUIRES: max_rows >= 1.
std::vector<std::uint8_t> SelectDescriptors(const DescriptorKind& kind,
                                            const std::vector<std::uint8_t>& bytes, int max_rows);

}  // namespace maploc
