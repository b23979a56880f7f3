#include "mapstore/model/map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace maploc {
namespace {

std::string At(std::string_view field, std::size_t index) {
  return std::string(field) + "[" + std::to_string(index) + "]";
}

Status ValidateIds(std::string_view field, const std::vector<LandmarkId>& ids) {
  for (std::size_t i = 1; i < ids.size(); ++i) {
    // Readers find landmarks by binary search.
    if (ids[i - 1] >= ids[i]) {
      return InvalidArgument(At(std::string(field) + ".ids", i), "ids must ascend");
    }
  }
  return Status::Ok();
}

Status ValidateDescriptors(std::string_view field, const DescriptorKind& kind, int landmark_count,
                           const Descriptors& descriptors,
                           const std::vector<std::int32_t>& descriptor_landmark) {
  const std::string name(field);
  // A segment without such landmarks need not name the kind.
  if (descriptors.size() == 0 && landmark_count == 0) return Status::Ok();
  if (descriptors.kind != kind) {
    return InvalidArgument(
        name + ".descriptors",
        "their kind '" + descriptors.kind.name + "' differs from the map's '" + kind.name + "'");
  }
  const std::size_t rows = descriptor_landmark.size();
  if (descriptors.bytes.size() != rows * static_cast<std::size_t>(kind.bytes)) {
    return InvalidArgument(name + ".descriptors", "their bytes do not fit their count");
  }
  for (std::size_t i = 0; i < rows; ++i) {
    const std::int32_t index = descriptor_landmark[i];
    const bool ascends = i == 0 || descriptor_landmark[i - 1] <= index;
    if (index < 0 || index >= landmark_count || !ascends) {
      return InvalidArgument(At(name + ".descriptor_landmark", i),
                             "must ascend within the landmarks");
    }
  }
  return Status::Ok();
}

bool IsValid(const ViewingRange& range) {
  constexpr float kMaxNormError = 1e-3f;  // of a unit vector that was rounded
  const Eigen::Vector3f& toward = range.toward_cameras_in_map;
  const bool is_direction =
      !range.IsKnown() || std::abs(toward.norm() - 1.0f) <= kMaxNormError;  // NaN: neither
  return is_direction && range.max_angle_rad >= 0 &&
         range.max_angle_rad <= std::numbers::pi_v<float> && range.min_distance >= 0 &&
         range.min_distance <= range.max_distance && std::isfinite(range.max_distance);
}

// `viewing` is one a landmark, or none.
Status ValidateViewing(std::string_view field, std::size_t landmark_count,
                       const std::vector<ViewingRange>& viewing) {
  if (!viewing.empty() && viewing.size() != landmark_count) {
    return InvalidArgument(std::string(field), "their count differs from the ids'");
  }
  for (std::size_t i = 0; i < viewing.size(); ++i) {
    if (IsValid(viewing[i])) continue;
    return InvalidArgument(
        At(field, i),
        "must be a unit direction or zero, an angle in [0, pi] and finite distances that ascend");
  }
  return Status::Ok();
}

}  // namespace

int CountUsableLines(const LineLandmarks& lines) {
  return static_cast<int>(
      std::count_if(lines.segments_in_map.begin(), lines.segments_in_map.end(), IsUsableLine));
}

Status ValidateSegment(const MapInfo& map, const Segment& segment) {
  const PointLandmarks& points = segment.points;
  const LineLandmarks& lines = segment.lines;
  if (points.positions_in_map.size() != points.ids.size()) {
    return InvalidArgument("points.positions_in_map", "their count differs from the ids'");
  }
  if (lines.segments_in_map.size() != lines.ids.size()) {
    return InvalidArgument("lines.segments_in_map", "their count differs from the ids'");
  }
  MAPLOC_RETURN_IF_ERROR(ValidateIds("points", points.ids));
  MAPLOC_RETURN_IF_ERROR(ValidateIds("lines", lines.ids));
  for (std::size_t i = 0; i < points.positions_in_map.size(); ++i) {
    if (!points.positions_in_map[i].allFinite()) {
      return InvalidArgument(At("points.positions_in_map", i), "must be finite");
    }
  }
  for (std::size_t i = 0; i < lines.segments_in_map.size(); ++i) {
    const LineSegment3& line = lines.segments_in_map[i];
    if (!line.start.allFinite() || !line.end.allFinite() || line.start == line.end) {
      return InvalidArgument(At("lines.segments_in_map", i), "must be finite and have a length");
    }
  }
  MAPLOC_RETURN_IF_ERROR(ValidateViewing("points.viewing", points.ids.size(), points.viewing));
  MAPLOC_RETURN_IF_ERROR(ValidateViewing("lines.viewing", lines.ids.size(), lines.viewing));
  MAPLOC_RETURN_IF_ERROR(ValidateDescriptors("points", map.point_descriptor, points.size(),
                                             points.descriptors, points.descriptor_landmark));
  return ValidateDescriptors("lines", map.line_descriptor, lines.size(), lines.descriptors,
                             lines.descriptor_landmark);
}

}  // namespace maploc
