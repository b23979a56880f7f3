// Names of the files that stand beside a store: one each, by whatever name the store is opened.
#pragma once

#include <string>
#include <string_view>

namespace maploc {

// The store's path without links, and `suffix`. The store itself need not exist yet.
std::string BesideStore(const std::string& store_path, std::string_view suffix);

}  // namespace maploc
