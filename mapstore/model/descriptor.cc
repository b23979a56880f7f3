#include "mapstore/model/descriptor.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

#include "mapstore/base/median.h"

namespace maploc {

namespace {

// Rows enough for a median, however many there are.
constexpr int kScaleSamples = 256;
constexpr double kSiftLength = 512.0;
constexpr double kUnitLength = 256.0;
constexpr int kUnitZero = 128;
// The bytes of fewer floats may be a unit vector by chance.
constexpr int kFewestUnitElements = 16;
// Rounding leaves 511 to 514 of some 50,000 rows of three photo collections.
constexpr double kLengthTolerance = 0.05;

// What the rows of a kind have by its definition.
struct RowLength {
  double length = 0.0;
  int zero = 0;  // the byte of the number 0
  const char* cure = "";
};

std::optional<RowLength> LengthOf(const DescriptorKind& kind) {
  if (kind.name == "sift_root_u8" || kind.name == "sift_u8") {
    return RowLength{kSiftLength, 0, "scale its rows to length 1, then by 512, and cut at 255"};
  }
  if (kind.name.starts_with("unit")) {
    return RowLength{kUnitLength, kUnitZero,
                     "scale its rows to length 1, then by 256, add 128, and cut to 0 and 255"};
  }
  return std::nullopt;
}

double Length(std::span<const std::uint8_t> row, int zero) {
  int sum = 0;
  for (const int value : row) sum += (value - zero) * (value - zero);
  return std::sqrt(sum);
}

// N of "prefixN" where it is a number in [least, kMaxDescriptorBytes].
std::optional<int> NumberAfter(std::string_view prefix, std::string_view name, int least) {
  if (!name.starts_with(prefix)) return std::nullopt;
  int number = 0;
  const char* last = name.data() + name.size();
  const auto [end, error] = std::from_chars(name.data() + prefix.size(), last, number);
  const bool is_whole = error == std::errc() && end == last;
  return is_whole && number >= least && number <= kMaxDescriptorBytes ? std::optional(number)
                                                                      : std::nullopt;
}

}  // namespace

Result<DescriptorKind> DescriptorKindFromName(std::string_view name) {
  const std::string owned(name);
  if (name == "orb" || name == "lbd") return DescriptorKind{owned, 32, DescriptorMetric::kHamming};
  if (name == "sift_root_u8" || name == "sift_u8") {
    return DescriptorKind{owned, 128, DescriptorMetric::kL2U8};
  }
  if (const auto elements = NumberAfter("unit", name, kFewestUnitElements)) {
    return DescriptorKind{owned, *elements, DescriptorMetric::kL2U8};
  }
  if (const auto bytes = NumberAfter("binary", name, 1)) {
    return DescriptorKind{owned, *bytes, DescriptorMetric::kHamming};
  }
  return InvalidArgument("descriptor kind",
                         "'" + owned +
                             "' is unknown; known are orb, sift_root_u8, "
                             "sift_u8, lbd, unitN (N learned numbers, 16 to 512) "
                             "and binaryN (N bytes, 1 to 512)");
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

Result<Descriptors> FromUnitVectors(std::span<const float> values, int elements) {
  Descriptors rows;
  MAPLOC_ASSIGN_OR_RETURN(rows.kind, DescriptorKindFromName("unit" + std::to_string(elements)));
  rows.bytes.reserve(values.size());
  for (std::size_t begin = 0; begin < values.size(); begin += static_cast<std::size_t>(elements)) {
    const std::span<const float> row = values.subspan(begin, static_cast<std::size_t>(elements));
    const double length =
        std::sqrt(std::inner_product(row.begin(), row.end(), row.begin(), 0.0, std::plus<>(),
                                     [](double a, double b) { return a * b; }));
    if (!std::isfinite(length) || length == 0.0) {
      return InvalidArgument(
          "descriptors", "row " + std::to_string(rows.size()) + " is not finite or has no length");
    }
    for (const float value : row) {
      const double scaled = kUnitZero + std::round(kUnitLength * value / length);
      rows.bytes.push_back(static_cast<std::uint8_t>(std::clamp(scaled, 0.0, 255.0)));
    }
  }
  return rows;
}

Status CheckScale(const Descriptors& descriptors, std::string_view field) {
  const std::optional<RowLength> want = LengthOf(descriptors.kind);
  if (!want || descriptors.size() == 0) return Status::Ok();
  std::vector<double> lengths;
  for (int row = 0; row < descriptors.size(); row += 1 + descriptors.size() / kScaleSamples) {
    lengths.push_back(Length(descriptors.row(row), want->zero));
  }
  const double median = UpperMedian(std::move(lengths));
  if (std::abs(median - want->length) <= kLengthTolerance * want->length) return Status::Ok();
  return InvalidArgument(field,
                         "have a median length of " + std::to_string(std::lround(median)) + ", " +
                             descriptors.kind.name + " has " +
                             std::to_string(std::lround(want->length)) + ": " + want->cure,
                         "DESCRIPTOR_SCALE");
}

}  // namespace maploc
