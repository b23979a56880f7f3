// What a name must be before it goes onto the wire. gRPC's own refusal of text that is not UTF-8
// names no field (UNIMPLEMENTED, or nothing at all).
#pragma once

#include <string_view>

#include "mapstore/base/status.h"

namespace maploc {

// INVALID_ARGUMENT with the field's name in front: NOT_UTF8, TOO_LONG (more than kMaxIdBytes) or
// CONTROL_CHARACTER. The message shows the name's start in printable characters.
Status CheckName(std::string_view field, std::string_view name);

}  // namespace maploc
