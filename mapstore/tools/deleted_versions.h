// What --keep-versions has deleted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapstore/store/map_store.h"

namespace maploc {

// Versions of map `name` that are in `before` and no longer in the store, ascending.
Result<std::vector<std::int64_t>> DeletedSince(const std::vector<MapSummary>& before,
                                               const MapStore& store, const std::string& name);

// One line for each: "Version 2 is deleted."
void PrintDeleted(const std::vector<std::int64_t>& versions);

}  // namespace maploc
