// The checks that need both the query and the map, and the part of the random seed that comes from
// the query.
#pragma once

#include <cstdint>

#include "mapstore/base/status.h"
#include "mapstore/model/map.h"
#include "mapstore/model/query.h"

namespace maploc {

// FAILED_PRECONDITION (DESCRIPTOR_KIND_MISMATCH) if a descriptor kind of the query differs from the
// map's; INVALID_ARGUMENT unless there is exactly one view. Lines are accepted if the map has no
// lines; they match nothing.
Status CheckQuery(const Query& query, const MapInfo& map);

// A hash of the map's name, the direction of gravity and the pixel positions of the features. It
// does not depend on the sender or the time.
std::uint64_t ContentHash(const Query& query);

}  // namespace maploc
