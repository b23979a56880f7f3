// Puts a backup in a store's place.
#pragma once

#include <cstdint>
#include <string>

#include "mapstore/base/status.h"

namespace maploc {

struct RestoredStore {
  std::int64_t maps = 0;
  std::int64_t versions = 0;
  std::int64_t sessions = 0;
};

// `from` is a store, of which nothing is changed; it is copied, brought up to this program's schema
// and verified before anything happens to `store`, which need not exist. Then the copy takes its
// place in one step, and the old file goes with its log. After a failure the old store is as it
// was. UNAVAILABLE: STORE_IN_USE while a server serves the store or an import runs; RESTORE_FAILED.
// Else the errors of OpenSqliteStore and Verify, which are about `from`.
Result<RestoredStore> RestoreSqliteStore(const std::string& store, const std::string& from);

}  // namespace maploc
