#include "mapstore/formats/file_bytes.h"

#include <filesystem>
#include <fstream>

namespace maploc {

Result<std::string> ReadFileBytes(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return NotFound("file '" + path + "'", "FILE_NOT_FOUND");
  if (!std::filesystem::is_regular_file(status)) return InvalidFile(path, "is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return InvalidFile(path, "cannot be read: " + error.message());
  std::ifstream file(path, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (!file || !file.read(bytes.data(), static_cast<std::streamsize>(size))) {
    return InvalidFile(path, "cannot be read to its end; check its permissions");
  }
  return bytes;
}

}  // namespace maploc
