#include "server/sessions/map_version.h"

#include <string>

namespace maploc {

Status RequireMapVersion(const MapKey& served, std::int64_t required) {
  if (required == 0 || required == served.version) return Status::Ok();
  return FailedPrecondition("MAP_VERSION_MISMATCH",
                            "map_version: map '" + served.name + "' is served in version " +
                                std::to_string(served.version) + ", the request insists on " +
                                std::to_string(required) +
                                "; enable that one (maploc-map enable), or send 0 for any");
}

}  // namespace maploc
