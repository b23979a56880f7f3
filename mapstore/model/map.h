// What a map is: named, versioned, cut into segments along the mapping path. A segment holds all
// landmarks that its stretch of key frames saw, so segments overlap, and a landmark's id is the
// same in each of them.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mapstore/base/ids.h"
#include "mapstore/geometry/line.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/descriptor.h"
#include "mapstore/model/viewing.h"

namespace maploc {

struct MapInfo {
  MapKey key;
  bool metric = false;  // lengths are metres; else the unit is unknown
  Similarity3
      map_from_source;  // from the imported model's frame; its rotation puts gravity on (0, 0, -1)
  // Landmarks of one place err together by so much, seen from where the map was made: an angle
  // about each image axis (importers/shared_error.h); 0: not known.
  double shared_error_rad = 0.0;
  DescriptorKind point_descriptor;
  DescriptorKind line_descriptor;  // name empty when the map has no lines
  std::int64_t created_unix_ns = 0;
};

// Point landmarks as parallel arrays. A landmark has one descriptor row or more (one an observation
// that was kept).
struct PointLandmarks {
  std::vector<LandmarkId> ids;                    // ascending, unique
  std::vector<Eigen::Vector3d> positions_in_map;  // one a landmark
  // One a landmark, or empty: not known (maps made before the store's schema version 5).
  std::vector<ViewingRange> viewing;
  Descriptors descriptors;
  std::vector<std::int32_t> descriptor_landmark;  // one a descriptor row: index into ids; ascending

  int size() const { return static_cast<int>(ids.size()); }
};

struct LineLandmarks {
  std::vector<LandmarkId> ids;                // ascending, unique
  std::vector<LineSegment3> segments_in_map;  // one a landmark; the end points bound what was seen
  std::vector<ViewingRange> viewing;          // as a point's; of the segment's middle
  Descriptors descriptors;
  std::vector<std::int32_t> descriptor_landmark;

  int size() const { return static_cast<int>(ids.size()); }
};

// Immutable once loaded; shared between queries as shared_ptr<const Segment>.
struct Segment {
  MapKey map;
  SegmentId id = 0;
  std::vector<Eigen::Vector3d> path_in_map;  // the key frames' camera centres, in the path's order
  PointLandmarks points;
  LineLandmarks lines;
};

// Lines of at least kMinUsableTiltRad (geometry/line.h).
int CountUsableLines(const LineLandmarks& lines);

// Every invariant above and every number finite; names the field that breaks one
// ("points.descriptor_landmark[7]").
Status ValidateSegment(const MapInfo& map, const Segment& segment);

}  // namespace maploc
