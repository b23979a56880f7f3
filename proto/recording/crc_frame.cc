#include "proto/recording/crc_frame.h"

#include <zlib.h>

namespace maploc {
namespace {

void PutLittleEndian(std::uint32_t value, char* to) {
  for (int byte = 0; byte < 4; ++byte) to[byte] = static_cast<char>(value >> (8 * byte));
}

std::uint32_t GetLittleEndian(const char* from) {
  std::uint32_t value = 0;
  for (int byte = 0; byte < 4; ++byte) {
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(from[byte])) << (8 * byte);
  }
  return value;
}

}  // namespace

Frame FrameOf(std::string_view record) {
  const auto* bytes = reinterpret_cast<const Bytef*>(record.data());
  const uLong crc = crc32(0, bytes, static_cast<uInt>(record.size()));
  return {static_cast<std::uint32_t>(record.size()), static_cast<std::uint32_t>(crc)};
}

std::array<char, kFrameBytes> FrameToBytes(const Frame& frame) {
  std::array<char, kFrameBytes> bytes{};
  PutLittleEndian(frame.length, bytes.data());
  PutLittleEndian(frame.crc, bytes.data() + 4);
  return bytes;
}

Frame FrameFromBytes(const std::array<char, kFrameBytes>& bytes) {
  return {GetLittleEndian(bytes.data()), GetLittleEndian(bytes.data() + 4)};
}

}  // namespace maploc
