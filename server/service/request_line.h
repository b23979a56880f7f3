// A request as one line of the log. Internal to server/service.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/service/request_log.h"

namespace maploc {

// The members of a JSON object without its braces, or key=value with JSON's values: no control
// character, whatever a client has sent. With `stages` a localization's times are part of it.
std::string RequestLine(const FinishedRequest& request, bool json, bool stages);
// Refusals that had no line of their own.
std::string CountLine(std::string_view method, std::string_view reason, std::int64_t count,
                      bool json);

}  // namespace maploc
