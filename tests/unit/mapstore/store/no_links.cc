#include "tests/unit/mapstore/store/no_links.h"

#include <atomic>
#include <cerrno>

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace maploc::testing {
namespace {

std::atomic<bool> no_links = false;

}  // namespace

NoLinks::NoLinks() { no_links = true; }
NoLinks::~NoLinks() { no_links = false; }

}  // namespace maploc::testing

// In place of the C library's.
extern "C" int link(const char* from, const char* to) noexcept {
  if (maploc::testing::no_links) return errno = EPERM, -1;
  return static_cast<int>(syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0));
}
