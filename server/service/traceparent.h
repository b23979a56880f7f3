// W3C Trace Context: which trace a call belongs to, as its client says in the header `traceparent`.
#pragma once

#include <string>
#include <string_view>

namespace maploc {

// The header's first 55 characters (version, trace, parent, flags), all of them hexadecimal digits
// and dashes; "" where it is not valid. Fields that a later version adds are cut off.
std::string ParseTraceparent(std::string_view header);

}  // namespace maploc
