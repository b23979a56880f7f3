// Names that people choose: of maps, robots, labels and requests. They go into logs, tables and
// rows, where a control character could forge a line or hide what follows it.
#pragma once

#include <string>
#include <string_view>

#include "mapstore/base/status.h"

namespace maploc {

// INVALID_ARGUMENT with `field` in front: TOO_LONG (over kMaxIdBytes), NOT_UTF8, or
// CONTROL_CHARACTER (Unicode's categories Cc, Zl, Zp, and Cf but for the two joiners that scripts
// and emoji need). An empty name is fine.
Status CheckName(std::string_view field, std::string_view name);

// How an error names the label `key`: "labels[key]"; "labels" where a bracket of the key would end
// the field early, so that the rest of the key passes for the cause.
std::string LabelField(std::string_view key);

}  // namespace maploc
