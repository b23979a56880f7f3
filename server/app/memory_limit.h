// How much memory this process may use.
#pragma once

#include <cstdint>
#include <filesystem>

namespace maploc {

// Bytes of the machine, or of the tightest control group (v2, or v1 as containers see it) that this
// process is in. `root` is where /proc and /sys are.
std::int64_t MemoryLimit(const std::filesystem::path& root = "/");

}  // namespace maploc
