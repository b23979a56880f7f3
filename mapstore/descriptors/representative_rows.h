// The few descriptor rows of a landmark that place recognition searches.
#pragma once

#include <vector>

#include "mapstore/model/descriptor.h"

namespace maploc {

// Two rows rank segments as well as all rows, one does not (MEASUREMENTS.md).
inline constexpr int kRepresentativeRows = 2;

// Of rows [begin, end) at most kRepresentativeRows, ascending, to which the sum of distances from
// all of them is smallest (chosen greedily; of more than 16 rows an even sample is looked at).
// Deterministic; thread-safe. REQUIRES: valid rows.
std::vector<int> RepresentativeRows(const Descriptors& descriptors, int begin, int end);

}  // namespace maploc
