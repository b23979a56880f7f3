// A map's frame turned about its origin.
#pragma once

#include <Eigen/Geometry>

#include "mapstore/model/map.h"

namespace maploc {

// Everything in the segment that has a place or a direction, in the turned frame. A field of
// landmarks that has either must be turned here too.
Segment RotateSegment(const Eigen::Quaterniond& turned_from_map, Segment segment);

}  // namespace maploc
