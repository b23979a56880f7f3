// The lines of a store's file of tokens: JSON to values and back. The file may be anybody's work:
// every field is checked, and numbers of things are bounded.
#pragma once

#include <string>
#include <string_view>

#include "mapstore/base/status.h"
#include "server/access/token_file.h"

namespace maploc {

inline constexpr std::size_t kMaxTokenFileBytes = 16 << 20;  // some 50,000 tokens
inline constexpr std::size_t kMaxMapsOfToken = 1000;

// INVALID_ARGUMENT with the field: what no token can be for.
Status CheckGrant(const Grant& grant);

std::string CreatedLine(const std::string& id, const TokenRecord& record);
std::string RevokedLine(const std::string& id, std::int64_t unix_ns);

// What ends with a line's end; the rest was not written whole, and counts as not there. Errors are
// InvalidFile with `path` and the line.
Result<TokenRecords> ParseTokenLines(const std::string& path, std::string_view text);

}  // namespace maploc
