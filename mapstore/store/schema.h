// The schema and how it came to be: migration i takes a store from version i to i + 1. Released
// ones are never edited, only added to. FORMAT.md explains the tables.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace maploc {

// PRAGMA application_id of every store: "mapl".
inline constexpr std::int32_t kStoreApplicationId = 0x6d61706c;

std::span<const std::string_view> StoreMigrations();

// Stores of before have no pointers from pages back to those that name them, and cannot shrink.
inline constexpr int kVersionShrinkable = 10;

// PRAGMA user_version of a store that this program writes.
inline int StoreSchemaVersion() { return static_cast<int>(StoreMigrations().size()); }

}  // namespace maploc
