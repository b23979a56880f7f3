#include "mapstore/base/name.h"

#include <utf8proc.h>

#include "mapstore/base/ids.h"

namespace maploc {
namespace {

constexpr utf8proc_int32_t kZeroWidthNonJoiner = 0x200c;
constexpr utf8proc_int32_t kZeroWidthJoiner = 0x200d;

bool IsControl(utf8proc_int32_t code_point) {
  switch (utf8proc_category(code_point)) {
    case UTF8PROC_CATEGORY_CC:
    case UTF8PROC_CATEGORY_ZL:
    case UTF8PROC_CATEGORY_ZP:
      return true;
    // Format characters: among them are those that turn the direction of writing. Scripts and emoji
    // need the two joiners.
    case UTF8PROC_CATEGORY_CF:
      return code_point != kZeroWidthNonJoiner && code_point != kZeroWidthJoiner;
    default:
      return false;
  }
}

}  // namespace

std::string LabelField(std::string_view key) {
  if (key.find_first_of("[]") != std::string_view::npos) return "labels";
  return "labels[" + std::string(key) + "]";
}

Status CheckName(std::string_view field, std::string_view name) {
  if (name.size() > kMaxIdBytes) {
    return InvalidArgument(field,
                           "is " + std::to_string(name.size()) + " bytes long, at most " +
                               std::to_string(kMaxIdBytes) + " are allowed",
                           "TOO_LONG");
  }
  const auto* next = reinterpret_cast<const utf8proc_uint8_t*>(name.data());
  auto left = static_cast<utf8proc_ssize_t>(name.size());
  while (left > 0) {
    utf8proc_int32_t code_point = 0;
    const utf8proc_ssize_t read = utf8proc_iterate(next, left, &code_point);
    if (read <= 0) {
      const auto at = static_cast<utf8proc_ssize_t>(name.size()) - left;
      return InvalidArgument(field,
                             "is not UTF-8 at byte " + std::to_string(at) +
                                 "; is it of a terminal or a file with another encoding?",
                             "NOT_UTF8");
    }
    if (IsControl(code_point)) {
      return InvalidArgument(field, "holds a control character", "CONTROL_CHARACTER");
    }
    next += read;
    left -= read;
  }
  return Status::Ok();
}

}  // namespace maploc
