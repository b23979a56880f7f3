#include "mapstore/formats/file_bytes.h"

#include <algorithm>
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

std::string_view WithoutByteOrderMark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

Result<std::string> ReadTextFile(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(std::string text, ReadFileBytes(path));
  // Before the search for NUL bytes, which UTF-16 has in every line.
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return InvalidFile(path + ":1", "is UTF-16 text; save it as UTF-8");
  }
  if (const std::size_t nul = text.find('\0'); nul != std::string::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(nul), '\n');
    return InvalidFile(path + ":" + std::to_string(line),
                       "holds a NUL byte, so it is no text; is it a binary file, or UTF-16?");
  }
  text.erase(0, text.size() - WithoutByteOrderMark(text).size());
  // Only where no line ends with LF. The CR of a CRLF is skipped as a blank (text_fields.h).
  if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
  return text;
}

}  // namespace maploc
