// maploc's line-track text file: the 3D lines of a model with the images that saw them and, unlike
// LIMAP's and Line3D++'s files, with their descriptors, so that a map's lines can be matched
// without its photos. UTF-8 text, one record a line, fields apart by blanks, '#' starts a comment:
//
//   maploc-lines 1 lbd
//   ID  X1 Y1 Z1  X2 Y2 Z2  N IMAGE_1 .. IMAGE_N  M HEX_1 .. HEX_M
//
// The first record names the format, its version and the descriptors' kind ("none" where no line
// has a descriptor; then M is 0 everywhere). Coordinates are in the frame and unit of the COLMAP
// model that the images belong to; IMAGE is that model's image id; HEX is one descriptor of the
// kind's bytes, two digits a byte. Ids are not negative and unique, end points differ, N is at
// least 1, and an image stands in a track once.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/geometry/line.h"
#include "mapstore/model/descriptor.h"

namespace maploc {

inline constexpr int kMaxLineTracks = 10'000'000;
inline constexpr int kMaxTrackLength = 100'000;  // images, and descriptors, of one line

struct LineTrack {
  std::int64_t id = 0;
  LineSegment3 segment_in_source;
  std::vector<std::int64_t> image_ids;  // in the file's order; at least one
};

struct LineTracks {
  std::vector<LineTrack> tracks;               // in the file's order
  Descriptors descriptors;                     // kind.name is empty when there are none
  std::vector<std::int32_t> descriptor_track;  // one a descriptor row: index into tracks; ascending
};

// Error: INVALID_ARGUMENT that names path:line, or NOT_FOUND for a missing file.
Result<LineTracks> ReadLineTracks(const std::string& path);

// REQUIRES: what the format demands (above). Numbers keep their full precision.
Status WriteLineTracks(const std::string& path, const LineTracks& tracks);

}  // namespace maploc
