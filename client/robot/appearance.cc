#include "client/robot/appearance.h"

namespace maploc {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"summer", "autumn", "winter", "spring"};

// Chosen until houses and trees learn different strategies, not measured outdoors: the campus shows
// how the selector works and is no evidence for it (MEASUREMENTS.md).
// A row a kind, a column a season (in the enums' order).
constexpr Change kChanges[kLandmarkKinds][4] = {
    // corners on walls: light and shadow move, notices go, one window looks like the next
    {{0.10, 0.30, 0.04}, {0.20, 0.50, 0.08}, {0.30, 0.60, 0.11}, {0.20, 0.50, 0.08}},
    // leaves: even in summer the wind moves them; in winter there are none, and twigs instead
    {{0.15, 0.40, 0.05}, {0.30, 0.60, 0.10}, {0.50, 0.75, 0.13}, {0.30, 0.60, 0.10}},
    // stones and kerbs: under leaves in autumn, under snow in winter
    {{0.10, 0.15, 0.04}, {0.35, 0.40, 0.08}, {0.60, 0.50, 0.10}, {0.20, 0.30, 0.08}},
    // edges of walls and windows
    {{0.10, 0.10, 0.03}, {0.15, 0.15, 0.06}, {0.20, 0.25, 0.08}, {0.15, 0.15, 0.06}},
    // trunks
    {{0.15, 0.20, 0.04}, {0.20, 0.30, 0.08}, {0.20, 0.35, 0.09}, {0.20, 0.30, 0.08}},
    // branches: hidden by leaves, bent by wind, one like the next
    {{0.20, 0.70, 0.06}, {0.30, 0.80, 0.11}, {0.40, 0.90, 0.13}, {0.30, 0.80, 0.11}},
    // poles of a scaffold: all alike, and put up anew every few weeks
    {{0.20, 0.60, 0.04}, {0.40, 0.90, 0.08}, {0.40, 0.90, 0.10}, {0.40, 0.90, 0.08}},
};

}  // namespace

std::string_view SeasonName(Season season) { return kNames[static_cast<int>(season)]; }

std::optional<Season> SeasonFromName(std::string_view name) {
  for (const Season season : kSeasons) {
    if (SeasonName(season) == name) return season;
  }
  return std::nullopt;
}

Change ChangeOf(LandmarkKind kind, Season season) {
  return kChanges[static_cast<int>(kind)][static_cast<int>(season)];
}

Appearance AppearanceOf(Season season) {
  Appearance appearance;
  for (int kind = 0; kind < kLandmarkKinds; ++kind) {
    appearance[kind] = ChangeOf(static_cast<LandmarkKind>(kind), season);
  }
  return appearance;
}

BinaryDescriptor RandomDescriptor(Random& random) {
  BinaryDescriptor descriptor;
  for (std::uint8_t& byte : descriptor) byte = static_cast<std::uint8_t>(random.Below(256));
  return descriptor;
}

BinaryDescriptor Flipped(BinaryDescriptor descriptor, double flip, Random& random) {
  for (std::uint8_t& byte : descriptor) {
    for (int bit = 0; bit < 8; ++bit) {
      if (random.Uniform() < flip) byte = static_cast<std::uint8_t>(byte ^ (1 << bit));
    }
  }
  return descriptor;
}

}  // namespace maploc
