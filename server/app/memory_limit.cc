#include "server/app/memory_limit.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <unistd.h>

namespace maploc {
namespace {

std::int64_t MachineMemory() {
  return static_cast<std::int64_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
}

// `limit` where the file has no number ("max", or it is not there) or a larger one.
std::int64_t Tighter(std::int64_t limit, const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::int64_t bytes = 0;
  return stream >> bytes && bytes > 0 ? std::min(limit, bytes) : limit;
}

// "/system.slice/maploc.service" of the line "0::/system.slice/maploc.service"; "/" without one.
std::filesystem::path ControlGroup(const std::filesystem::path& root) {
  std::ifstream stream(root / "proc/self/cgroup");
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("0::/")) return line.substr(3);
  }
  return "/";
}

}  // namespace

std::int64_t MemoryLimit(const std::filesystem::path& root) {
  const std::filesystem::path groups = root / "sys/fs/cgroup";
  // Version 1. In a container its own group is mounted at the root; outside of one the root has no
  // limit.
  std::int64_t limit = Tighter(MachineMemory(), groups / "memory/memory.limit_in_bytes");
  // A group is bound by those above it, too.
  std::filesystem::path group = groups;
  limit = Tighter(limit, group / "memory.max");
  for (const std::filesystem::path& part : ControlGroup(root).relative_path()) {
    group /= part;
    limit = Tighter(limit, group / "memory.max");
  }
  return limit;
}

}  // namespace maploc
