// The mapping drive: once around the campus in summer, written as the files that maploc-map
// imports.
#pragma once

#include <string>

#include "client/robot/simulated_view.h"
#include "mapstore/base/status.h"

namespace maploc {

struct MappingOptions {
  double position_noise_m = 0.01;  // of mapped points, each axis
  double line_noise_m = 0.01;      // of the ends of mapped lines, each axis
  double start_m = -8.0;           // along the lane: the camera looks ahead
  // Within one drive nothing changes its look, so that tracks hold together.
  SightOptions sight{.clutter_points = 0, .clutter_lines = 0, .look_alikes = false};
};

struct MappingSummary {
  int key_frames = 0;
  int points = 0;
  int lines = 0;
};

// Writes `directory`/model (a COLMAP text model), /database.db (descriptors of kind orb) and
// /lines.txt (formats/line_tracks.h), in the world's frame: gravity is (0, 0, -1), the unit a
// metre.
Result<MappingSummary> WriteMappingDrive(const World& world, const MappingOptions& options,
                                         const std::string& directory);

}  // namespace maploc
