// What the selection experiment runs on: one map, and several sessions over it whose reference
// poses are known.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/importers/colmap_importer.h"
#include "mapstore/model/query.h"
#include "server/pipeline/map_snapshot.h"

namespace maploc::selection {

enum class Scene { kStructured, kUnstructured, kMixture };

struct SetQuery {
  std::string name;
  Query query;
  Rigid3 map_from_body;        // the reference; no estimator sees it
  std::optional<Scene> scene;  // what stands there; nullopt: unknown
};

struct SetSession {
  std::string name;
  std::vector<SetQuery> queries;
};

struct SelectionSet {
  std::shared_ptr<const MapSnapshot> map;  // every segment without evidence: mixed
  std::vector<SetSession> sessions;        // in the order of time
};

// Imports a COLMAP model as maploc-map does, into a store in memory, and loads it as the server
// does.
Result<std::shared_ptr<const MapSnapshot>> ImportMap(const ColmapImportOptions& options);

}  // namespace maploc::selection
