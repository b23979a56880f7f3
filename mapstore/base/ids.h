// Names of things, each its own type so that they cannot be mixed up.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace maploc {

// A map's name and the version an import gave it (1, 2, ...; within a name, newer is larger).
struct MapKey {
  std::string name;
  std::int64_t version = 0;
  auto operator<=>(const MapKey&) const = default;
};

// Counts from 0 within one map version, along the mapping path.
using SegmentId = std::int32_t;

// Names one landmark in all segments of a map version that hold it; points and lines count apart.
using LandmarkId = std::int64_t;

// Opaque, made by the server, at most kMaxIdBytes printable ASCII characters.
using SessionId = std::string;
inline constexpr int kMaxIdBytes = 128;

}  // namespace maploc
