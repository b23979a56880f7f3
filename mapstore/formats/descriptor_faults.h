// Bytes that cannot be descriptors, whatever their kind. Only for this folder.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace maploc {

// What is wrong with the rows of one image, and the cure; "" when nothing is. Rows that are all the
// same, or mostly of one repeated byte, came of a failed extraction or copy (eight at least).
std::string FindDescriptorFault(std::span<const std::uint8_t> bytes, std::size_t columns);

// Whether most rows are unit vectors when their bytes are read as float32: learned descriptors. No
// other bytes are so by chance.
bool AreUnitVectors(std::span<const std::uint8_t> bytes, std::size_t columns);

}  // namespace maploc
