// Reading a binary file in memory: never past its end, never trusting a count. Only for this
// folder. Little-endian, as COLMAP writes.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "mapstore/base/status.h"

namespace maploc {

static_assert(std::endian::native == std::endian::little, "the files here are little-endian");

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  std::size_t offset() const { return offset_; }
  std::size_t remaining() const { return bytes_.size() - offset_; }

  template <typename T>
  Result<T> Read(std::string_view what) {
    if (remaining() < sizeof(T)) return Ends(what);
    T value;
    std::memcpy(&value, bytes_.data() + offset_, sizeof(T));
    offset_ += sizeof(T);
    return value;
  }
  // Up to and without a NUL byte.
  Result<std::string> ReadString(std::string_view what) {
    const std::size_t end = bytes_.find('\0', offset_);
    if (end == std::string_view::npos) return Ends(what);
    std::string text(bytes_.substr(offset_, end - offset_));
    offset_ = end + 1;
    return text;
  }
  // A 64-bit count of things of at least `bytes_each`: never more than the file can still hold.
  Result<std::size_t> ReadCount(std::string_view what, std::size_t bytes_each) {
    MAPLOC_ASSIGN_OR_RETURN(const auto count, Read<std::uint64_t>(what));
    if (count > remaining() / bytes_each) {
      return InvalidArgument(what, "is " + std::to_string(count) + ", more than the " +
                                       std::to_string(remaining()) +
                                       " bytes left can hold; the file is truncated or damaged");
    }
    return static_cast<std::size_t>(count);
  }

 private:
  Status Ends(std::string_view what) const {
    return InvalidArgument(what, "the file ends here; it is truncated");
  }

  std::string_view bytes_;
  std::size_t offset_ = 0;
};

}  // namespace maploc
