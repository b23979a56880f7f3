#include "server/app/transport_limits.h"

#include <algorithm>

#include <sys/resource.h>

namespace maploc {
namespace {

// The store's connections, its log, the port file, gRPC's own; 17 are usual.
constexpr std::size_t kOwnDescriptors = 64;
constexpr std::size_t kMaxConnections = 8192;
constexpr std::size_t kLeastConnections = 8;

}  // namespace

void RaiseDescriptorLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

std::size_t MaxConnections() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return kLeastConnections;
  const std::size_t descriptors = std::max<std::size_t>(limit.rlim_cur, kOwnDescriptors);
  return std::clamp(descriptors - kOwnDescriptors, kLeastConnections, kMaxConnections);
}

}  // namespace maploc
