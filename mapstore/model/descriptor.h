// Descriptors: what kind they are, and rows of bytes. A map has one kind for points and one for
// lines; a query's kinds must equal them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mapstore/base/status.h"

namespace maploc {

enum class DescriptorMetric {
  kHamming = 1,  // bits that differ
  kL2U8 = 2,     // Euclidean over unsigned bytes
};

struct DescriptorKind {
  std::string name;  // "orb", "sift_root_u8", "sift_u8", "lbd", "unit128", "binary48", ...; lower
                     // case, empty for "none"
  int bytes = 0;     // of one descriptor, in [1, kMaxDescriptorBytes]; 0 for "none"
  DescriptorMetric metric = DescriptorMetric::kHamming;

  bool operator==(const DescriptorKind&) const = default;
};

inline constexpr int kMaxDescriptorBytes = 512;

// A known name: "orb" (32 bytes, Hamming), "sift_root_u8" (128, L2: L1-root normalized, times 512
// as COLMAP does), "sift_u8" (128, L2: OpenCV's own scale), "lbd" (32 bytes, Hamming), "unitN" (N
// bytes, 16 to 512, L2: FromUnitVectors), "binaryN" (N bytes, Hamming). Error: names the known
// ones.
Result<DescriptorKind> DescriptorKindFromName(std::string_view name);

// "'orb' (32 bytes, Hamming distance)": all that two kinds can differ in.
std::string ToText(const DescriptorKind& kind);

// Rows of equal length in one block. Plain value.
struct Descriptors {
  DescriptorKind kind;
  std::vector<std::uint8_t> bytes;  // row-major; size() * kind.bytes

  int size() const { return kind.bytes == 0 ? 0 : static_cast<int>(bytes.size()) / kind.bytes; }
  std::span<const std::uint8_t> row(int index) const {
    return {bytes.data() + static_cast<std::size_t>(index) * kind.bytes,
            static_cast<std::size_t>(kind.bytes)};
  }
};

// The rows at `indices`, in their order. REQUIRES: each in [0, all.size()).
Descriptors GatherRows(const Descriptors& all, std::span<const std::int32_t> indices);

// Learned descriptors (ALIKED, SuperPoint, DISK), rows of `elements` float32, as kind unitN: each
// row is scaled to length 1, times 256, plus 128, rounded, cut to [0, 255]. So bytes are compared
// as the floats are, for a quarter of the memory (MEASUREMENTS of server/matching). Error:
// `elements` is no such kind's, or names the first row that is not finite or has no length.
// REQUIRES: whole rows.
Result<Descriptors> FromUnitVectors(std::span<const float> values, int elements);

// INVALID_ARGUMENT (DESCRIPTOR_SCALE) where most rows cannot be what their kind's name says: both
// kinds of SIFT have length 512 by definition, those of unitN have 256 about 128, and those scaled
// otherwise (to 255, to 1) match a third of what they should, without a word. Other kinds have no
// length. Looks at a sample.
Status CheckScale(const Descriptors& descriptors, std::string_view field);

}  // namespace maploc
