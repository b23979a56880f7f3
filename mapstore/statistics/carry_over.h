// What a map's sessions taught, carried over to a new version of it: to the segments that hold the
// same landmarks. Pure functions.
//
// A landmark's id is its index in one import, so ids say nothing across versions. The same landmark
// is the one at the same place: old positions are moved into the new map's frame (by both versions'
// map_from_source: an extended or rebuilt model keeps its source frame), and a pair is two
// landmarks that are each other's nearest, within a tolerance, among those not yet paired.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "mapstore/model/map.h"
#include "mapstore/model/session.h"

namespace maploc {

// Of the row of `from`, a segment of the old version, the share `weight` goes to `to`, one of the
// new version.
struct CarriedShare {
  SegmentId from = 0;
  SegmentId to = 0;
  double weight = 0.0;  // in (0, 1]
  bool operator==(const CarriedShare&) const = default;
};

// One segment's landmarks: their ids in its version (a landmark may be in several segments).
struct SegmentLandmarks {
  SegmentId segment = 0;
  std::vector<LandmarkId> ids;
  std::vector<Eigen::Vector3d> positions;  // one an id, in a frame common to both versions
};

// The middles of lines and the points, in the new map's frame. Ids of lines are made negative
// (-1 - id), so that they meet no point's.
SegmentLandmarks LandmarksOf(const Segment& segment, const Similarity3& new_map_from_map);

// A hundredth of the median distance from a landmark to the nearest key frame of its segment: five
// pixels at a focal length of 500, whatever the map's unit. 0 without landmarks or path.
double SharedLandmarkTolerance(std::span<const Segment> segments);

// A segment's weights sum to the share of its landmarks that still exist, at most 1. A landmark
// counts in only one of the new segments that hold it: the one that shares most landmarks with the
// old segment; between equals the smallest, then the one with the old segment's id, then the lowest
// id. So an identical map always inherits with weights of exactly 1, and a segment's statistics do
// not spread to its neighbours. Ascending by (from, to).
std::vector<CarriedShare> CarryOver(std::span<const SegmentLandmarks> old_segments,
                                    std::span<const SegmentLandmarks> new_segments,
                                    double tolerance);

// One session's rows of the old version as rows of the new one, ascending by segment. Each row is
// shared out among its heirs and, where its weights sum to less than 1, nobody: queries by weight,
// localized and failed ones each by the largest remainder (between equals the first share), matches
// likewise in proportion to the localized queries that each heir got. So counts are kept: over the
// heirs they never sum to more than the old ones, and to just these where the weights sum to 1; no
// row has more inliers than matches. Medians are means weighted by localized queries. Segments that
// get no query have no row. REQUIRES: `rows` are of one session; `shares` have all heirs of each
// row, in the same order whenever it is asked.
std::vector<SegmentSessionRow> CarryRows(std::span<const SegmentSessionRow> rows,
                                         std::span<const CarriedShare> shares);

}  // namespace maploc
