// Whether a robot gets the version of a map that it insists on.
#pragma once

#include <cstdint>

#include "mapstore/base/ids.h"
#include "mapstore/base/status.h"

namespace maploc {

// `required` 0: any. FAILED_PRECONDITION (MAP_VERSION_MISMATCH) names both.
Status RequireMapVersion(const MapKey& served, std::int64_t required);

}  // namespace maploc
