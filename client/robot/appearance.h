// How the made-up world looks with the seasons. A landmark has a descriptor of random bits. Seen
// again, some bits are flipped; and now and then what is seen there has come to look like another
// landmark of its kind (new leaves like other leaves, one window like the next), which is how wrong
// matches arise in real places. How often depends on the season and on the kind of landmark: leaves
// suffer strongly, the edges of walls little. The map is made in summer.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "mapstore/base/random.h"

namespace maploc {

enum class Season { kSummer, kAutumn, kWinter, kSpring };
inline constexpr std::array<Season, 4> kSeasons = {Season::kSummer, Season::kAutumn,
                                                   Season::kWinter, Season::kSpring};
std::string_view SeasonName(Season season);  // "summer", ...
std::optional<Season> SeasonFromName(std::string_view name);

enum class LandmarkKind {
  kWallPoint,
  kLeafPoint,
  kGroundPoint,
  kWallLine,
  kTrunkLine,
  kBranchLine,
  kScaffoldLine
};
inline constexpr int kLandmarkKinds = 7;

// What happens to one observation of a landmark. Probabilities.
struct Change {
  double unseen;      // not detected at all
  double look_alike;  // its descriptor is another landmark's of its kind
  double flip;        // of each bit, in any case
};
Change ChangeOf(LandmarkKind kind, Season season);

// How a day shows every kind of landmark, in the order of LandmarkKind.
using Appearance = std::array<Change, kLandmarkKinds>;
Appearance AppearanceOf(Season season);

using BinaryDescriptor = std::array<std::uint8_t, 32>;

BinaryDescriptor RandomDescriptor(Random& random);
// Each bit turned with probability `flip`.
BinaryDescriptor Flipped(BinaryDescriptor descriptor, double flip, Random& random);

}  // namespace maploc
