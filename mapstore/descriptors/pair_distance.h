// The distance of one descriptor to another, by Highway's run-time dispatch as distance_kernels.h.
#pragma once

#include <cstdint>

#include "mapstore/model/descriptor.h"

namespace maploc::kernels {

// Between two descriptors of row_bytes, as Neighbours' distances.
std::uint32_t Distance(DescriptorMetric metric, int row_bytes, const std::uint8_t* a,
                       const std::uint8_t* b);

}  // namespace maploc::kernels
