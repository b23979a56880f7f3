// The demo's picture: the campus from above, its map's segments coloured by strategy, and where the
// robots truly were and believed to be.
#pragma once

#include <string>
#include <vector>

#include "client/api/client.h"
#include "client/robot/replay.h"
#include "client/robot/simulated_world.h"

namespace maploc {

// "#1f77b4" and so on.
std::string StrategyColour(Strategy strategy);

// Writes an SVG file. `segments` come with their paths. REQUIRES: the entries are of robots in this
// world and map.
Status WriteCampusPicture(const std::string& path, const World& world, const MapInfo& map,
                          const std::vector<RemoteSegment>& segments,
                          const std::vector<ReplayReport>& sessions);

}  // namespace maploc
