#include "mapstore/model/descriptor.h"

#include <charconv>

namespace maploc {

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

}  // namespace maploc
