// Bytes that cannot be descriptors, whatever their kind. Only for this folder.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace maploc {

// What is wrong with the rows of one image, and the cure; "" when nothing is. Rows that are all the
// same, or mostly of one repeated byte, came of a failed extraction or copy (eight at least). Rows
// that are unit vectors when their bytes are read as float32 were learned: their bits mean nothing
// apart.
std::string FindDescriptorFault(std::span<const std::uint8_t> bytes, std::size_t columns);

}  // namespace maploc
