// Lines that another program made, from maploc's line-track text file (formats/line_tracks.h).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/importers/tracks.h"
#include "mapstore/model/descriptor.h"

namespace maploc {

struct ImportedLines {
  DescriptorKind kind;  // empty name when the file has no line
  std::vector<LineTrackInMap> lines;
};

// Error names the file: a track names an image that is not among the frames, or a line has no
// descriptor (nothing could ever match it).
Result<ImportedLines> ReadLines(const std::string& path, std::span<const KeyFrame> frames,
                                const Similarity3& map_from_source);

}  // namespace maploc
