#include "server/service/payload_hash.h"

#include <array>
#include <functional>
#include <string_view>

#include <google/protobuf/io/zero_copy_stream.h>
#include <google/protobuf/message_lite.h>

namespace maploc {
namespace {

// Takes a message's bytes block by block, so that the largest ones are not copied as a whole.
class HashingStream final : public google::protobuf::io::ZeroCopyOutputStream {
 public:
  bool Next(void** data, int* size) override {
    Fold();
    *data = block_.data();
    *size = static_cast<int>(block_.size());
    used_ = block_.size();
    return true;
  }
  void BackUp(int count) override { used_ -= static_cast<std::size_t>(count); }
  std::int64_t ByteCount() const override { return folded_ + static_cast<std::int64_t>(used_); }

  std::uint64_t Finish() {
    Fold();
    return hash_;
  }

 private:
  void Fold() {
    // 2^64 divided by the golden ratio: the order of blocks counts, and an odd factor loses no bit.
    constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15ull;
    const std::string_view bytes(block_.data(), used_);
    // Not safe against an adversary, and need not be: who makes two queries collide harms its own
    // session alone.
    hash_ = hash_ * kOdd + std::hash<std::string_view>()(bytes);
    folded_ += static_cast<std::int64_t>(used_);
    used_ = 0;
  }

  std::array<char, 8192> block_;
  std::size_t used_ = 0;
  std::int64_t folded_ = 0;
  std::uint64_t hash_ = 0;
};

}  // namespace

std::uint64_t PayloadHash(const google::protobuf::MessageLite& message) {
  HashingStream stream;
  // The same fields give the same bytes, because a LocalizeRequest has no map field, whose entries
  // protobuf writes in any order.
  message.SerializeToZeroCopyStream(&stream);
  return stream.Finish();
}

}  // namespace maploc
