// What only a query and a map together can violate, and the seed that a query brings.
#pragma once

#include <cstdint>

#include "mapstore/base/status.h"
#include "mapstore/model/map.h"
#include "mapstore/model/query.h"

namespace maploc {

// FAILED_PRECONDITION (DESCRIPTOR_KIND_MISMATCH) where the query's kinds are not the map's;
// INVALID_ARGUMENT naming the field for any number of views but one. Lines
// sent to a map without lines are fine: they match nothing.
Status CheckQuery(const Query& query, const MapInfo& map);

// The same for the same features and gravity, whoever sends them and when.
std::uint64_t ContentHash(const Query& query);

}  // namespace maploc
