#include "server/sessions/session_id.h"

#include <array>
#include <cerrno>
#include <cstdint>

#include <sys/random.h>

namespace maploc {

Result<SessionId> NewSessionId() {
  std::array<std::uint8_t, 16> bytes;
  ssize_t got = -1;
  do {
    // Up to 256 bytes come whole. Only while the pool is not ready yet, at boot, may a signal
    // interrupt.
    got = getrandom(bytes.data(), bytes.size(), 0);
  } while (got < 0 && errno == EINTR);
  if (got != static_cast<ssize_t>(bytes.size())) return Internal("the kernel gives no randomness");
  constexpr char kDigits[] = "0123456789abcdef";
  SessionId id;
  for (const std::uint8_t byte : bytes) {
    id.push_back(kDigits[byte >> 4]);
    id.push_back(kDigits[byte & 15]);
  }
  return id;
}

}  // namespace maploc
