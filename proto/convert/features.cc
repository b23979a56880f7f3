#include "proto/convert/features.h"

#include <cmath>

#include "proto/convert/checks.h"
#include "proto/convert/convert.h"

namespace maploc::convert {
namespace {

Status CheckCoordinates(const v1::Features& features, const std::string& field,
                        int numbers_a_feature) {
  const std::string name = field + ".coordinates_pixels";
  const int count = features.coordinates_pixels_size();
  if (count % numbers_a_feature != 0) {
    return InvalidArgument(name,
                           "holds " + std::to_string(count) + " numbers, not a multiple of " +
                               std::to_string(numbers_a_feature),
                           "COUNT_MISMATCH");
  }
  if (count / numbers_a_feature > kMaxFeatures) {
    return ResourceExhausted("TOO_MANY_FEATURES",
                             name + ": holds " + std::to_string(count / numbers_a_feature) +
                                 " features, at most " + std::to_string(kMaxFeatures) +
                                 " are allowed; send the strongest");
  }
  const float* values = features.coordinates_pixels().data();
  for (int i = 0; i < count; ++i) {
    if (!std::isfinite(values[i])) {
      return InvalidArgument(At(name, i), "must be finite", "NOT_FINITE");
    }
    if (std::abs(values[i]) > kMaxCoordinatePx) {
      return InvalidArgument(At(name, i), "is out of range", "OUT_OF_RANGE");
    }
  }
  return Status::Ok();
}

Result<Descriptors> DescriptorsFromProto(const v1::Features& features, const std::string& field,
                                         int feature_count) {
  Descriptors result;
  MAPLOC_ASSIGN_OR_RETURN(
      result.kind, DescriptorKindFromProto(features.descriptor_kind(), field + ".descriptor_kind"));
  if (feature_count > 0 && result.kind.name.empty()) {
    return InvalidArgument(field + ".descriptor_kind", "is required where there are features",
                           "REQUIRED");
  }
  const std::string& bytes = features.descriptors();
  const auto expected = static_cast<std::size_t>(feature_count) * result.kind.bytes;
  if (bytes.size() != expected) {
    return InvalidArgument(field + ".descriptors",
                           "holds " + std::to_string(bytes.size()) + " bytes, " +
                               std::to_string(feature_count) + " descriptors of " +
                               std::to_string(result.kind.bytes) + " bytes take " +
                               std::to_string(expected),
                           "DESCRIPTOR_LENGTH");
  }
  result.bytes.assign(bytes.begin(), bytes.end());
  // A client that scales its SIFT otherwise would match far fewer landmarks, without a word.
  MAPLOC_RETURN_IF_ERROR(CheckScale(result, field + ".descriptors"));
  return result;
}

void DescriptorsToProto(const Descriptors& descriptors, v1::Features* proto) {
  proto->set_descriptors(descriptors.bytes.data(), descriptors.bytes.size());
  DescriptorKindToProto(descriptors.kind, proto->mutable_descriptor_kind());
}

void AppendPoint(const Eigen::Vector2f& point_px, v1::Features* proto) {
  proto->add_coordinates_pixels(point_px.x());
  proto->add_coordinates_pixels(point_px.y());
}

}  // namespace

Result<PointFeatures> PointFeaturesFromProto(const v1::Features& features,
                                             const std::string& field) {
  // First, because it bounds the count by which the rest allocates.
  MAPLOC_RETURN_IF_ERROR(CheckCoordinates(features, field, 2));
  const int count = features.coordinates_pixels_size() / 2;
  PointFeatures result;
  MAPLOC_ASSIGN_OR_RETURN(result.descriptors, DescriptorsFromProto(features, field, count));
  const float* values = features.coordinates_pixels().data();
  result.keypoints_px.reserve(count);
  for (int i = 0; i < count; ++i) {
    result.keypoints_px.emplace_back(values[2 * i], values[2 * i + 1]);
  }
  return result;
}

Result<LineFeatures> LineFeaturesFromProto(const v1::Features& features, const std::string& field) {
  MAPLOC_RETURN_IF_ERROR(CheckCoordinates(features, field, 4));
  const int count = features.coordinates_pixels_size() / 4;
  LineFeatures result;
  MAPLOC_ASSIGN_OR_RETURN(result.descriptors, DescriptorsFromProto(features, field, count));
  const float* values = features.coordinates_pixels().data();
  result.starts_px.reserve(count);
  result.ends_px.reserve(count);
  for (int i = 0; i < count; ++i) {
    const float* line = values + 4 * i;
    result.starts_px.emplace_back(line[0], line[1]);
    result.ends_px.emplace_back(line[2], line[3]);
    if (result.starts_px.back() == result.ends_px.back()) {
      return InvalidArgument(At(field + ".coordinates_pixels", 4 * i),
                             "line " + std::to_string(i) + " starts where it ends",
                             "DEGENERATE_LINE");
    }
  }
  return result;
}

void PointFeaturesToProto(const PointFeatures& points, v1::Features* proto) {
  proto->mutable_coordinates_pixels()->Reserve(static_cast<int>(points.keypoints_px.size()) * 2);
  for (const Eigen::Vector2f& keypoint_px : points.keypoints_px) AppendPoint(keypoint_px, proto);
  DescriptorsToProto(points.descriptors, proto);
}

void LineFeaturesToProto(const LineFeatures& lines, v1::Features* proto) {
  proto->mutable_coordinates_pixels()->Reserve(lines.size() * 4);
  for (int i = 0; i < lines.size(); ++i) {
    AppendPoint(lines.starts_px[i], proto);
    AppendPoint(lines.ends_px[i], proto);
  }
  DescriptorsToProto(lines.descriptors, proto);
}

}  // namespace maploc::convert
