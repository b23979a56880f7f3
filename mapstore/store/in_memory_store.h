// A store that lives and dies with the process: for tests and for trying things out. The contract
// suite holds it to the same promises as the SQLite one, disk apart.
#pragma once

#include <memory>

#include "mapstore/store/map_store.h"

namespace maploc {

std::unique_ptr<MapStore> NewInMemoryStore(const StoreOptions& options = {});

}  // namespace maploc
