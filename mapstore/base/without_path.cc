#include "mapstore/base/without_path.h"

#include <cstddef>
#include <string_view>

namespace maploc {
namespace {

bool IsOfName(char c) {
  constexpr std::string_view kOthers = "_-./";
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
         static_cast<unsigned char>(c) >= 0x80 || kOthers.find(c) != std::string_view::npos;
}

// Whether a path ends before `rest`. What stands beside a store (its log: "PATH-wal") begins with
// its path, and a full stop may follow.
bool EndsBefore(std::string_view rest) {
  return rest.empty() || !IsOfName(rest.front()) || rest.front() == '-' || rest.front() == '.';
}

// Where a path that is found at `at` begins: a relative one's folders belong to it, as in the
// absolute path of the same file. npos: it is only the end of another name.
std::size_t BeginOf(std::string_view all, std::size_t at) {
  if (at == 0 || !IsOfName(all[at - 1])) return at;
  if (all[at] == '/' || all[at - 1] != '/') return std::string_view::npos;
  while (at > 0 && IsOfName(all[at - 1])) --at;
  return at;
}

}  // namespace

std::string WithoutPath(const std::string& message, const std::string& path) {
  if (path.find('/') == std::string::npos) return message;
  const std::string_view all = message;
  std::string result;
  std::size_t done = all.starts_with(path + ": ") ? path.size() + 2 : 0;
  for (std::size_t at = all.find(path, done); at != all.npos; at = all.find(path, at + 1)) {
    const std::size_t begin = BeginOf(all, at);
    const std::size_t end = at + path.size();
    if (begin == all.npos || begin < done || !EndsBefore(all.substr(end))) continue;
    result += all.substr(done, begin - done);
    result += "STORE";
    done = end;
  }
  return result.append(all.substr(done));
}

}  // namespace maploc
