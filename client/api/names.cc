#include "client/api/names.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>

#include "mapstore/base/ids.h"

namespace maploc {
namespace {

constexpr std::size_t kShownBytes = 48;

bool IsControl(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7f;
}

// Length of the character at the start of `text` (RFC 3629), 0 where there is none. REQUIRES: text
// is not empty.
std::size_t CharacterLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  std::uint32_t code = first & (0x7fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0u) != 0x80u) return 0;
    code = code << 6 | (byte(i) & 0x3fu);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};  // else it is overlong
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return code >= kLeast[length] && code <= 0x10ffff && !surrogate ? length : 0;
}

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = CharacterLength(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

// What a terminal can show whatever the bytes are: 'caf\xe9.jpg'.
std::string Shown(std::string_view name) {
  std::string shown = "'";
  for (const char c : name.substr(0, kShownBytes)) {
    const bool plain = !IsControl(c) && static_cast<unsigned char>(c) < 0x80;
    char escaped[5];
    std::snprintf(escaped, sizeof(escaped), "\\x%02x", static_cast<unsigned char>(c));
    shown += plain ? std::string(1, c) : std::string(escaped);
  }
  return shown + (name.size() > kShownBytes ? "...'" : "'");
}

}  // namespace

Status CheckName(std::string_view field, std::string_view name) {
  if (!IsUtf8(name)) {
    return InvalidArgument(field, Shown(name) + " is not UTF-8; names are sent as UTF-8 alone",
                           "NOT_UTF8");
  }
  if (name.size() > kMaxIdBytes) {
    return InvalidArgument(field,
                           Shown(name) + " is " + std::to_string(name.size()) +
                               " bytes long, at most " + std::to_string(kMaxIdBytes) +
                               " are allowed; choose a shorter one",
                           "TOO_LONG");
  }
  if (std::ranges::any_of(name, IsControl)) {
    return InvalidArgument(field, Shown(name) + " holds a control character", "CONTROL_CHARACTER");
  }
  return Status::Ok();
}

}  // namespace maploc
