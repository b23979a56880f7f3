#include "mapstore/formats/descriptor_faults.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace maploc {
namespace {

using Row = std::span<const std::uint8_t>;

// Fewer rows are no failed extraction but a picture without much in it.
constexpr std::size_t kMinRows = 8;

bool IsConstant(Row row) {
  return row.size() > 1 &&
         std::all_of(row.begin(), row.end(), [&](std::uint8_t byte) { return byte == row[0]; });
}

// No bytes that are not float32 are a unit vector of so many elements by chance.
bool IsFloatUnitVector(Row row) {
  constexpr std::size_t kMinElements = 16;
  if (row.size() % sizeof(float) != 0 || row.size() < kMinElements * sizeof(float)) return false;
  double squares = 0.0;
  for (std::size_t i = 0; i < row.size(); i += sizeof(float)) {
    float element;
    std::memcpy(&element, &row[i], sizeof(element));
    squares += double{element} * double{element};
  }
  return std::abs(squares - 1.0) < 0.02;  // NaN: no
}

}  // namespace

std::string FindDescriptorFault(std::span<const std::uint8_t> bytes, std::size_t columns) {
  const std::size_t rows = columns == 0 ? 0 : bytes.size() / columns;
  if (rows == 0) return "";
  std::size_t constant = 0;
  std::size_t like_first = 0;
  const Row first = bytes.first(columns);
  for (std::size_t i = 0; i < rows; ++i) {
    const Row row = bytes.subspan(i * columns, columns);
    constant += IsConstant(row) ? 1 : 0;
    like_first += std::equal(row.begin(), row.end(), first.begin()) ? 1 : 0;
  }
  const std::string count = std::to_string(rows);
  const std::string again = "; extract the features of this image again";
  if (rows >= kMinRows && 2 * constant > rows) {
    return std::to_string(constant) + " of its " + count + " descriptors are one byte repeated" +
           again;
  }
  if (rows >= kMinRows && like_first == rows)
    return "its " + count + " descriptors are all equal" + again;
  return "";
}

bool AreUnitVectors(std::span<const std::uint8_t> bytes, std::size_t columns) {
  const std::size_t rows = columns == 0 ? 0 : bytes.size() / columns;
  std::size_t unit_vectors = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    unit_vectors += IsFloatUnitVector(bytes.subspan(i * columns, columns)) ? 1 : 0;
  }
  return 2 * unit_vectors > rows;
}

}  // namespace maploc
