// The days on which robots drive around the simulated campus, and the places it has. The map is
// made on another day, in summer. Every number was chosen from plausibility before the first run;
// README.md says why, and what was changed since.
#pragma once

#include <string_view>
#include <vector>

#include "client/robot/simulated_world.h"

namespace maploc::selection {

struct CampusDay {
  std::string_view name;
  double gravity_noise_deg;  // of that day's robot
  Appearance appearance;
};

// In the order of time.
const std::vector<CampusDay>& CampusDays();

CampusOptions CampusPlaces();

}  // namespace maploc::selection
