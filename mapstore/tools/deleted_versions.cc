#include "mapstore/tools/deleted_versions.h"

#include <algorithm>
#include <iostream>

namespace maploc {

Result<std::vector<std::int64_t>> DeletedSince(const std::vector<MapSummary>& before,
                                               const MapStore& store, const std::string& name) {
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> after, store.ListVersions());
  // By comparison, because the store deletes in the transaction that publishes and returns no list.
  std::vector<std::int64_t> deleted;
  for (const MapSummary& map : before) {
    const MapKey& key = map.info.key;
    const bool stays = std::ranges::any_of(
        after, [&key](const MapSummary& other) { return other.info.key == key; });
    if (key.name == name && !stays) deleted.push_back(key.version);
  }
  return deleted;
}

void PrintDeleted(const std::vector<std::int64_t>& versions) {
  for (const std::int64_t version : versions) {
    std::cout << "Version " << version << " is deleted.\n";
  }
}

}  // namespace maploc
