// The log as one JSON object a line, for programs that collect logs.
#pragma once

#include <memory>

#include <spdlog/formatter.h>

namespace maploc {

// {"time": UTC, "level": ..., "message": ...}
std::unique_ptr<spdlog::formatter> JsonMessages();
// The same of what is logged as the members of a JSON object.
std::unique_ptr<spdlog::formatter> JsonMembers();

}  // namespace maploc
