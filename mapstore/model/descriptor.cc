#include "mapstore/model/descriptor.h"

#include <charconv>
#include <cmath>
#include <utility>

#include "mapstore/base/median.h"

namespace maploc {

namespace {

constexpr int kScaleSamples = 256;
constexpr double kSiftLength = 512.0;
// Rounding leaves 511 to 514 of some 50,000 rows of three photo collections.
constexpr double kSiftLengthTolerance = 25.0;

double Length(std::span<const std::uint8_t> row) {
  int sum = 0;
  for (const int value : row) sum += value * value;
  return std::sqrt(sum);
}

}  // namespace

Result<DescriptorKind> DescriptorKindFromName(std::string_view name) {
  const std::string owned(name);
  if (name == "orb" || name == "lbd") return DescriptorKind{owned, 32, DescriptorMetric::kHamming};
  if (name == "sift_root_u8" || name == "sift_u8") {
    return DescriptorKind{owned, 128, DescriptorMetric::kL2U8};
  }
  constexpr std::string_view kBinary = "binary";
  if (name.starts_with(kBinary)) {
    int bytes = 0;
    const char* first = name.data() + kBinary.size();
    const char* last = name.data() + name.size();
    const auto [end, error] = std::from_chars(first, last, bytes);
    if (error == std::errc() && end == last && bytes >= 1 && bytes <= kMaxDescriptorBytes) {
      return DescriptorKind{owned, bytes, DescriptorMetric::kHamming};
    }
  }
  return InvalidArgument("descriptor kind", "'" + owned +
                                                "' is unknown; known are orb, sift_root_u8, "
                                                "sift_u8, lbd and binaryN (N bytes, 1 to 512)");
}

std::string ToText(const DescriptorKind& kind) {
  const char* metric = kind.metric == DescriptorMetric::kHamming ? "Hamming" : "L2";
  return "'" + kind.name + "' (" + std::to_string(kind.bytes) + " bytes, " + metric + " distance)";
}

Descriptors GatherRows(const Descriptors& all, std::span<const std::int32_t> indices) {
  Descriptors rows{all.kind, {}};
  rows.bytes.reserve(indices.size() * all.kind.bytes);
  for (const std::int32_t index : indices) {
    const std::span<const std::uint8_t> row = all.row(index);
    rows.bytes.insert(rows.bytes.end(), row.begin(), row.end());
  }
  return rows;
}

Status CheckScale(const Descriptors& descriptors, std::string_view field) {
  const std::string& name = descriptors.kind.name;
  if ((name != "sift_root_u8" && name != "sift_u8") || descriptors.size() == 0) return Status::Ok();
  std::vector<double> lengths;
  for (int row = 0; row < descriptors.size(); row += 1 + descriptors.size() / kScaleSamples) {
    lengths.push_back(Length(descriptors.row(row)));
  }
  const double median = UpperMedian(std::move(lengths));
  if (std::abs(median - kSiftLength) <= kSiftLengthTolerance) return Status::Ok();
  return InvalidArgument(field,
                         "have a median length of " + std::to_string(std::lround(median)) + ", " +
                             name + " has 512: scale its rows to length 1, then by 512, and cut " +
                             "at 255",
                         "DESCRIPTOR_SCALE");
}

}  // namespace maploc
