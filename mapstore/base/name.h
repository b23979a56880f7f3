// Names that people choose: of maps, robots, labels and requests. They go into logs, tables and
// rows, where a control character could forge a line or hide what follows it.
#pragma once

#include <string_view>

#include "mapstore/base/status.h"

namespace maploc {

// INVALID_ARGUMENT with `field` in front: TOO_LONG (over kMaxIdBytes), NOT_UTF8, or
// CONTROL_CHARACTER (Unicode's categories Cc, Zl, Zp, and Cf but for the two joiners that scripts
// and emoji need). An empty name is fine.
Status CheckName(std::string_view field, std::string_view name);

}  // namespace maploc
