#include "mapstore/features/image_end.h"

#include <cstddef>
#include <cstdint>

namespace maploc {
namespace {

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kJpegStart("\xFF\xD8\xFF", 3);

std::size_t BigEndian(std::string_view bytes, std::size_t at, int count) {
  std::size_t value = 0;
  for (int i = 0; i < count; ++i) {
    value = value << 8 | static_cast<std::uint8_t>(bytes[at + static_cast<std::size_t>(i)]);
  }
  return value;
}

// Chunks of length, type, data and checksum, the last one of type IEND.
bool PngEndsEarly(std::string_view bytes) {
  // Four bytes each of length, type and checksum.
  constexpr std::size_t kAround = 12;
  std::size_t at = kPngSignature.size();
  while (at + kAround <= bytes.size()) {
    const std::size_t end = at + kAround + BigEndian(bytes, at, 4);
    if (end > bytes.size()) return true;
    if (bytes.substr(at + 4, 4) == "IEND") return false;
    at = end;
  }
  return true;
}

// Segments with their length, so that a thumbnail's end inside of one is passed over; after a
// scan's header come coded bytes, where a marker is FF and neither 0 (a stuffed FF), FF (fill) nor
// a restart.
bool JpegEndsEarly(std::string_view bytes) {
  constexpr std::uint8_t kEnd = 0xD9;
  std::size_t at = 2;
  while (at + 1 < bytes.size()) {
    const auto code = static_cast<std::uint8_t>(bytes[at + 1]);
    const bool is_marker = static_cast<std::uint8_t>(bytes[at]) == 0xFF && code != 0x00 &&
                           code != 0xFF && !(code >= 0xD0 && code <= 0xD7);
    if (!is_marker) {
      ++at;
      continue;
    }
    if (code == kEnd) return false;
    if (at + 4 > bytes.size()) return true;
    at += 2 + BigEndian(bytes, at + 2, 2);
  }
  return true;
}

}  // namespace

bool EndsWithMark(std::string_view last_bytes) {
  constexpr std::string_view kPngEnd("\0\0\0\0IEND\xAE\x42\x60\x82", kEndMarkBytes);
  return last_bytes.ends_with(kPngEnd) || last_bytes.ends_with("\xFF\xD9");
}

bool EndsEarly(std::string_view bytes) {
  if (bytes.starts_with(kPngSignature)) return PngEndsEarly(bytes);
  return bytes.starts_with(kJpegStart) && JpegEndsEarly(bytes);
}

}  // namespace maploc
