#include "mapstore/base/names.h"

#include <cstdint>
#include <string>

#include "mapstore/base/ids.h"

namespace maploc {
namespace {

// How many bytes the character at the start of `text` takes; 0: it is none.
std::size_t CharacterBytes(std::string_view text) {
  const auto first = static_cast<std::uint8_t>(text[0]);
  if (first < 0x80) return 1;
  const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < bytes) return 0;
  std::uint32_t code = first & (0x7Fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    const auto next = static_cast<std::uint8_t>(text[i]);
    if ((next & 0xC0) != 0x80) return 0;
    code = code << 6 | (next & 0x3Fu);
  }
  const bool is_overlong = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  return is_overlong || is_surrogate || code > 0x10FFFF ? 0 : bytes;
}

bool IsControl(char c) { return static_cast<std::uint8_t>(c) < 0x20 || c == 0x7F; }

}  // namespace

std::optional<std::size_t> FindNonUtf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = CharacterBytes(text.substr(at));
    if (bytes == 0) return at;
    at += bytes;
  }
  return std::nullopt;
}

Status CheckName(std::string_view field, std::string_view name) {
  if (name.size() > static_cast<std::size_t>(kMaxIdBytes)) {
    return InvalidArgument(field,
                           "is " + std::to_string(name.size()) + " bytes long, at most " +
                               std::to_string(kMaxIdBytes) + " are allowed",
                           "TOO_LONG");
  }
  for (const char c : name) {
    if (IsControl(c)) {
      return InvalidArgument(field, "holds a control character", "CONTROL_CHARACTER");
    }
  }
  if (const auto at = FindNonUtf8(name)) {
    return InvalidArgument(field,
                           "is not UTF-8 at byte " + std::to_string(*at) +
                               "; is it of a terminal or a file with another encoding?",
                           "NOT_UTF8");
  }
  return Status::Ok();
}

}  // namespace maploc
