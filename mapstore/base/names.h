// Names that people give: of maps, robots and sessions. They go into logs, rows and protobuf
// strings, so that what these cannot hold is refused at the door.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "mapstore/base/status.h"

namespace maploc {

// Where the first byte stands that is not UTF-8 (no surrogates, nothing longer than need be);
// nullopt: all of it is.
std::optional<std::size_t> FindNonUtf8(std::string_view text);

// INVALID_ARGUMENT that begins with `field`: TOO_LONG (kMaxIdBytes), CONTROL_CHARACTER or NOT_UTF8.
// An empty name is none of these.
Status CheckName(std::string_view field, std::string_view name);

}  // namespace maploc
