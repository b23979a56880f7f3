// Geometry of one 3D line and the segments seen of it. All 2D coordinates are normalized (plane
// z = 1); distances are in the normalized plane, times the focal length they are pixels.
#pragma once

#include <optional>
#include <span>

#include "mapstore/geometry/line.h"
#include "mapstore/geometry/rigid3.h"

namespace maploc {

// A segment seen in a posed frame. LSD directs segments (dark on the left), so directions agree
// between views of one line.
struct LineObservation {
  Rigid3 camera_from_map;
  LineSegment2 normalized;
  double focal_length_px = 1.0;
};

// The segment of `a` lifted to 3D: its end points' rays cut the plane through `b`'s centre and
// segment. nullopt when a ray meets the plane at less than min_angle_rad (also: a line along the
// epipolar direction), behind either camera, or the two segments run in opposite directions.
std::optional<LineSegment3> IntersectPlanes(const LineObservation& a, const LineObservation& b,
                                            double min_angle_rad);

// The line's two ends in the frame; nullopt when one is not in front of the camera.
std::optional<LineSegment2> ProjectSegment(const Rigid3& camera_from_map,
                                           const LineSegment3& line_in_map);

// Whether two segments of one frame are of one line: the end points of the shorter lie within
// max_error of the longer one's line, in the same direction, and they overlap by min_overlap of the
// shorter one.
bool SegmentsAgree(const LineSegment2& a, const LineSegment2& b, double max_error,
                   double min_overlap);

// Whether `seen` shows `line`: it agrees with the line's projection within max_error_px.
bool ShowsLine(const LineObservation& seen, const LineSegment3& line_in_map, double max_error_px,
               double min_overlap);

struct RefinedLine {
  LineSegment3 segment_in_map;
  double sigma_m = 0.0;  // largest standard deviation across the line at its end points, map unit,
                         // for 1 px of noise
};

// The infinite line that minimizes the squared distances of all seen end points to its projection
// (Gauss-Newton over the four degrees of freedom, Huber at 1 px), bounded by the second outermost
// end points seen (the outermost where there are fewer than three views). nullopt when it does not
// converge, or the views do not determine it.
std::optional<RefinedLine> RefineLine(std::span<const LineObservation> views,
                                      const LineSegment3& start_in_map);

}  // namespace maploc
