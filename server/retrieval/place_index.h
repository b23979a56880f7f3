// What place recognition searches: every distinct point landmark of a map version once, described
// by a few rows, with the segments that hold it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mapstore/descriptors/segment_place.h"
#include "mapstore/model/descriptor.h"

namespace maploc {

// Immutable after Build, hence thread-safe.
class PlaceIndex {
 public:
  // Landmarks shared by segments are taken once, from the one with most descriptor rows for it.
  // Memory: their rows, 4 bytes a row, 12 bytes a landmark, and for each segment that holds it 4
  // bytes and 4 bytes a row. REQUIRES: valid (ValidatePlace), one descriptor kind.
  static PlaceIndex Build(std::span<const SegmentPlace> segments);

  int segment_count() const { return static_cast<int>(reach_.size()); }
  int landmark_count() const { return static_cast<int>(segment_begin_.size()) - 1; }
  // A landmark's id in the segments that hold it. `landmark` is one of this index, ascending by id.
  LandmarkId IdOf(std::int32_t landmark) const { return ids_[landmark]; }
  const Descriptors& descriptors() const { return descriptors_; }
  // One a descriptor row, ascending: index of a landmark of this index, in [0, landmark_count()).
  std::span<const std::int32_t> row_landmark() const { return row_landmark_; }
  // Indices into Build's segments, ascending.
  std::span<const std::int32_t> SegmentsOf(std::int32_t landmark) const;
  // The rows of descriptors() whose landmarks `segment` holds, ascending; an index into Build's
  // segments.
  std::span<const std::int32_t> RowsOf(int segment) const { return segment_rows_[segment]; }
  // How far off its path a segment can be seen from (SegmentPlace::reach). `segment` is an index
  // into Build's segments.
  double ReachOf(int segment) const { return reach_[segment]; }
  // The segment's path; may be empty.
  const std::vector<Eigen::Vector3d>& PathOf(int segment) const { return paths_[segment]; }

 private:
  void AddRows(const SegmentPlace& segment, std::int32_t landmark);

  Descriptors descriptors_;
  std::vector<std::int32_t> row_landmark_;
  std::vector<LandmarkId> ids_;
  std::vector<std::int32_t> segment_begin_ = {0};  // of each landmark in holders_, and the end
  std::vector<std::int32_t> holders_;
  std::vector<std::vector<std::int32_t>> segment_rows_;
  std::vector<double> reach_;
  std::vector<std::vector<Eigen::Vector3d>> paths_;
};

}  // namespace maploc
