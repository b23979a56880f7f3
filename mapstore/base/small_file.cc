#include "mapstore/base/small_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>

namespace maploc {

Result<std::string> ReadSmallFile(const std::string& path, const char* reason) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  // One byte more than allowed shows that a file is too large. Its size is not asked for, because a
  // device such as /dev/zero has none.
  std::string bytes(kMaxSmallFileBytes + 1, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  // A stream has no error text of its own, but errno still has the system call's.
  if (!file.is_open() || file.bad()) {
    return InvalidArgument(path,
                           std::string("cannot be read (") + std::strerror(errno) +
                               "); give a file that this program may read",
                           reason);
  }
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  if (bytes.size() <= kMaxSmallFileBytes) return bytes;
  return InvalidArgument(path, "has more than 1 MiB, which no key, certificate or token needs",
                         reason);
}

}  // namespace maploc
