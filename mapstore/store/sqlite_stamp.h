// A store's stamp: the row `commit_stamp` of `meta`. It starts as a random number and rises by one
// with every write transaction, so it names a state of one store's history: two files whose stamps
// are near each other are the same store at two moments, all others are unrelated files. Because
// every transaction writes it, it also stands in every write-ahead log that is not empty.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "mapstore/base/status.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

inline constexpr std::string_view kStampName = "commit_stamp";
// So large that SQLite always keeps it in eight bytes, which a log can be searched for.
inline constexpr std::int64_t kLeastStamp = std::int64_t{1} << 56;

// Nullopt: a store of a program from before stamps.
Result<std::optional<std::int64_t>> ReadStamp(SqliteDatabase& database);
// Gives a stamp to a store that has none. REQUIRES: write-ahead logging, no transaction.
Status EnsureStamp(SqliteDatabase& database);
// For a copy, which begins a history of its own. REQUIRES: no transaction.
Status RenewStamp(SqliteDatabase& database);
// REQUIRES: a write transaction.
Status RaiseStamp(SqliteDatabase& database);

struct StampInFile {
  std::optional<std::int64_t> stamp;
  std::int64_t page = 0;  // of the table `meta`
};
// Of the main file as it lies there, without its log. Takes no lock, so another process that writes
// the file at this moment may make it fail. DATA_LOSS where the file is no whole store.
Result<StampInFile> ReadStampInFile(const std::string& path);

}  // namespace maploc
