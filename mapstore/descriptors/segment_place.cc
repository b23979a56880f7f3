#include "mapstore/descriptors/segment_place.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "mapstore/base/median.h"
#include "mapstore/descriptors/representative_rows.h"
#include "mapstore/geometry/path_distance.h"

namespace maploc {
namespace {

// Landmarks enough for a median, whatever the segment's size.
constexpr int kReachSamples = 256;

double MedianReach(const Segment& segment) {
  const std::vector<Eigen::Vector3d>& positions = segment.points.positions_in_map;
  if (positions.empty() || segment.path_in_map.empty()) return 0.0;
  // A stride, so that the sample is from all over the segment.
  const std::size_t step = 1 + (positions.size() - 1) / kReachSamples;
  std::vector<double> distances;
  for (std::size_t i = 0; i < positions.size(); i += step) {
    distances.push_back(DistanceToPath(positions[i], segment.path_in_map));
  }
  return UpperMedian(std::move(distances));
}

// The representative rows of the landmark, which has rows [begin, end) of the segment.
void AppendRows(const Descriptors& all, int landmark, int begin, int end, SegmentPlace& place) {
  for (const int row : RepresentativeRows(all, begin, end)) {
    const auto bytes = all.row(row);
    place.descriptors.bytes.insert(place.descriptors.bytes.end(), bytes.begin(), bytes.end());
    place.descriptor_landmark.push_back(landmark);
  }
  place.row_counts.push_back(end - begin);
}

Status ValidateRows(const SegmentPlace& place) {
  for (std::size_t i = 0; i < place.descriptor_landmark.size(); ++i) {
    const std::int32_t landmark = place.descriptor_landmark[i];
    const bool ascends = i == 0 || place.descriptor_landmark[i - 1] <= landmark;
    if (landmark >= 0 && std::cmp_less(landmark, place.ids.size()) && ascends) continue;
    return InvalidArgument("place.descriptor_landmark[" + std::to_string(i) + "]",
                           "must ascend within the landmarks");
  }
  return Status::Ok();
}

}  // namespace

SegmentPlace PlaceOf(const Segment& segment) {
  const PointLandmarks& points = segment.points;
  SegmentPlace place;
  place.id = segment.id;
  place.path_in_map = segment.path_in_map;
  place.reach = MedianReach(segment);
  place.ids = points.ids;
  place.descriptors.kind = points.descriptors.kind;
  const auto rows = static_cast<int>(points.descriptor_landmark.size());
  int begin = 0;
  for (int landmark = 0; landmark < points.size(); ++landmark) {
    int end = begin;
    while (end < rows && points.descriptor_landmark[end] == landmark) ++end;
    AppendRows(points.descriptors, landmark, begin, end, place);
    begin = end;
  }
  return place;
}

Status ValidatePlace(const DescriptorKind& kind, const SegmentPlace& place) {
  if (!std::isfinite(place.reach) || place.reach < 0.0) {
    return InvalidArgument("place.reach", "must be finite and not negative");
  }
  if (place.row_counts.size() != place.ids.size()) {
    return InvalidArgument("place.row_counts", "their count differs from the ids'");
  }
  if (std::ranges::adjacent_find(place.ids, std::ranges::greater_equal()) != place.ids.end()) {
    return InvalidArgument("place.ids", "ids must ascend");
  }
  const std::size_t rows = place.descriptor_landmark.size();
  if (place.descriptors.bytes.size() != rows * static_cast<std::size_t>(kind.bytes)) {
    return InvalidArgument("place.descriptors", "their bytes do not fit their count");
  }
  return ValidateRows(place);
}

}  // namespace maploc
