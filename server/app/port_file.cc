#include "server/app/port_file.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace maploc {

Status WritePortFile(const std::string& path, int port) {
  const std::string unfinished = path + ".tmp";
  std::ofstream file(unfinished, std::ios::trunc);
  file << port << '\n';
  // Before the check, because a full disk shows only when the buffer is written.
  file.close();
  std::error_code error;
  if (file.good()) std::filesystem::rename(unfinished, path, error);
  if (file.good() && !error) return Status::Ok();
  return Status(StatusCode::kUnavailable, "CANNOT_WRITE",
                path + ": the port file cannot be written; does its folder exist?");
}

void RemovePortFile(const std::string& path) {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

}  // namespace maploc
