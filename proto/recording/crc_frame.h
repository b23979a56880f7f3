// How records lie in a recording's file: README.md, "Format". Only for this folder and the server's
// recorder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace maploc {

// A file begins with it; its last character is the format's version.
inline constexpr std::string_view kRecordingMagic = "maplocR1";
// Before each record: its length and its CRC-32, little-endian.
inline constexpr std::size_t kFrameBytes = 8;
// A request of the largest size with its answer has less.
inline constexpr std::size_t kMaxRecordBytes = 32 << 20;

struct Frame {
  std::uint32_t length = 0;
  std::uint32_t crc = 0;
  bool operator==(const Frame&) const = default;
};

// REQUIRES: at most kMaxRecordBytes.
Frame FrameOf(std::string_view record);
std::array<char, kFrameBytes> FrameToBytes(const Frame& frame);
Frame FrameFromBytes(const std::array<char, kFrameBytes>& bytes);

}  // namespace maploc
