#include "mapstore/store/codec.h"

#include <array>
#include <initializer_list>
#include <string>
#include <utility>

#include "mapstore/base/random.h"
#include "mapstore/store/little_endian.h"

namespace maploc {
namespace {

Status Damaged(std::string_view field, const std::string& message) {
  return Status(StatusCode::kDataLoss, "DAMAGED_SEGMENT", std::string(field) + ": " + message);
}

template <typename T>
Blob Encode(std::span<const T> values) {
  Blob blob;
  blob.reserve(values.size() * sizeof(T));
  for (const T value : values) AppendLittleEndian(value, blob);
  return blob;
}

// Direction x, y, z, the largest angle, the smallest and the largest distance (FORMAT.md).
constexpr std::size_t kFloatsOfView = 6;

Blob EncodeViewing(std::span<const ViewingRange> viewing) {
  Blob blob;
  blob.reserve(viewing.size() * kFloatsOfView * sizeof(float));
  for (const ViewingRange& range : viewing) {
    for (int axis = 0; axis < 3; ++axis)
      AppendLittleEndian(range.toward_cameras_in_map[axis], blob);
    AppendLittleEndian(range.max_angle_rad, blob);
    AppendLittleEndian(range.min_distance, blob);
    AppendLittleEndian(range.max_distance, blob);
  }
  return blob;
}

void AppendVector(const Eigen::Vector3d& vector, Blob& blob) {
  for (int axis = 0; axis < 3; ++axis) AppendLittleEndian(vector[axis], blob);
}

Eigen::Vector3d ReadVector(const std::uint8_t* bytes) {
  return {ReadLittleEndian<double>(bytes), ReadLittleEndian<double>(bytes + 8),
          ReadLittleEndian<double>(bytes + 16)};
}

std::uint64_t Hash(std::initializer_list<const Blob*> blobs) {
  std::uint64_t hash = HashBytes({});
  for (const Blob* blob : blobs) {
    hash = HashBytes({reinterpret_cast<const char*>(blob->data()), blob->size()}, hash);
  }
  return hash;
}

// Called before memory is allocated, so that a damaged count cannot ask for any amount of it. The
// length is divided, because the product with a damaged count could overflow.
Status CheckLength(std::string_view field, std::size_t bytes, std::int64_t count,
                   std::size_t width) {
  if (count >= 0 && bytes % width == 0 && bytes / width == static_cast<std::uint64_t>(count)) {
    return Status::Ok();
  }
  return Damaged(field, std::to_string(bytes) + " bytes do not hold " + std::to_string(count) +
                            " entries of " + std::to_string(width) + " bytes");
}

template <typename T>
Result<std::vector<T>> Decode(std::span<const std::uint8_t> bytes, std::int64_t count,
                              std::string_view field) {
  MAPLOC_RETURN_IF_ERROR(CheckLength(field, bytes.size(), count, sizeof(T)));
  std::vector<T> values(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = ReadLittleEndian<T>(bytes.data() + i * sizeof(T));
  }
  return values;
}

// An empty blob is no ranges: not known.
Result<std::vector<ViewingRange>> DecodeViewing(const FeatureBlobs& blobs, std::string_view field) {
  constexpr std::size_t kWidth = kFloatsOfView * sizeof(float);
  if (blobs.viewing.empty()) return std::vector<ViewingRange>();
  MAPLOC_RETURN_IF_ERROR(CheckLength(field, blobs.viewing.size(), blobs.count, kWidth));
  std::vector<ViewingRange> viewing(static_cast<std::size_t>(blobs.count));
  for (std::size_t i = 0; i < viewing.size(); ++i) {
    std::array<float, kFloatsOfView> numbers;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      numbers[k] = ReadLittleEndian<float>(blobs.viewing.data() + i * kWidth + k * sizeof(float));
    }
    viewing[i] = {Eigen::Vector3f(numbers.data()), numbers[3], numbers[4], numbers[5]};
  }
  return viewing;
}

Result<Descriptors> DecodeDescriptors(Blob rows, std::int64_t count, const DescriptorKind& kind,
                                      std::string_view field) {
  // Rows of 0 bytes: the map has no descriptors of this kind, and no count could be checked.
  if (kind.bytes > 0) {
    MAPLOC_RETURN_IF_ERROR(
        CheckLength(field, rows.size(), count, static_cast<std::size_t>(kind.bytes)));
  } else if (!rows.empty() || count != 0) {
    return Damaged(field, "the map has no descriptors of this kind");
  }
  return Descriptors{kind, std::move(rows)};
}

template <typename Blobs>
Status CheckChecksum(const Blobs& blobs, std::string_view field) {
  if (ChecksumOf(blobs) == blobs.checksum) return Status::Ok();
  return Damaged(field, "the checksum does not fit the content");
}

template <typename Landmarks>
FeatureBlobs EncodeLandmarks(const Landmarks& landmarks, Blob geometry) {
  FeatureBlobs blobs;
  blobs.count = landmarks.size();
  blobs.descriptor_count = static_cast<std::int64_t>(landmarks.descriptor_landmark.size());
  blobs.ids = Encode<LandmarkId>(landmarks.ids);
  blobs.geometry = std::move(geometry);
  blobs.owners = Encode<std::int32_t>(landmarks.descriptor_landmark);
  blobs.descriptors = landmarks.descriptors.bytes;
  blobs.viewing = EncodeViewing(landmarks.viewing);
  blobs.checksum = ChecksumOf(blobs);
  return blobs;
}

// What points and lines share; `what` is "points" or "lines".
template <typename Landmarks>
Status DecodeRest(const FeatureBlobs& blobs, const DescriptorKind& kind, const std::string& what,
                  Landmarks& landmarks) {
  MAPLOC_ASSIGN_OR_RETURN(
      landmarks.descriptor_landmark,
      Decode<std::int32_t>(blobs.owners, blobs.descriptor_count, what + ".descriptor_landmark"));
  MAPLOC_ASSIGN_OR_RETURN(
      landmarks.descriptors,
      DecodeDescriptors(blobs.descriptors, blobs.descriptor_count, kind, what + ".descriptors"));
  MAPLOC_ASSIGN_OR_RETURN(landmarks.viewing, DecodeViewing(blobs, what + ".viewing"));
  return CheckChecksum(blobs, what);
}

}  // namespace

std::uint64_t ChecksumOf(const FeatureBlobs& blobs) {
  return Hash({&blobs.ids, &blobs.geometry, &blobs.owners, &blobs.descriptors, &blobs.viewing});
}

std::uint64_t ChecksumOf(const PlaceBlobs& blobs) {
  Blob reach;
  AppendLittleEndian(blobs.reach, reach);
  return Hash({&blobs.ids, &blobs.row_counts, &blobs.owners, &blobs.descriptors, &reach});
}

Blob EncodePositions(std::span<const Eigen::Vector3d> positions) {
  Blob blob;
  blob.reserve(positions.size() * 24);
  for (const Eigen::Vector3d& position : positions) AppendVector(position, blob);
  return blob;
}

Result<std::vector<Eigen::Vector3d>> DecodePositions(std::span<const std::uint8_t> bytes,
                                                     std::int64_t count, std::string_view field) {
  MAPLOC_RETURN_IF_ERROR(CheckLength(field, bytes.size(), count, 24));
  std::vector<Eigen::Vector3d> positions(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = ReadVector(&bytes[24 * i]);
  return positions;
}

FeatureBlobs EncodePoints(const PointLandmarks& points) {
  return EncodeLandmarks(points, EncodePositions(points.positions_in_map));
}

FeatureBlobs EncodeLines(const LineLandmarks& lines) {
  Blob segments;
  segments.reserve(lines.segments_in_map.size() * 48);
  for (const LineSegment3& segment : lines.segments_in_map) {
    AppendVector(segment.start, segments);
    AppendVector(segment.end, segments);
  }
  return EncodeLandmarks(lines, std::move(segments));
}

Result<PointLandmarks> DecodePoints(const FeatureBlobs& blobs, const DescriptorKind& kind) {
  PointLandmarks points;
  MAPLOC_ASSIGN_OR_RETURN(points.ids, Decode<LandmarkId>(blobs.ids, blobs.count, "points.ids"));
  MAPLOC_ASSIGN_OR_RETURN(points.positions_in_map,
                          DecodePositions(blobs.geometry, blobs.count, "points.positions"));
  MAPLOC_RETURN_IF_ERROR(DecodeRest(blobs, kind, "points", points));
  return points;
}

Result<LineLandmarks> DecodeLines(const FeatureBlobs& blobs, const DescriptorKind& kind) {
  LineLandmarks lines;
  MAPLOC_ASSIGN_OR_RETURN(lines.ids, Decode<LandmarkId>(blobs.ids, blobs.count, "lines.ids"));
  MAPLOC_RETURN_IF_ERROR(CheckLength("lines.segments", blobs.geometry.size(), blobs.count, 48));
  lines.segments_in_map.resize(static_cast<std::size_t>(blobs.count));
  for (std::size_t i = 0; i < lines.segments_in_map.size(); ++i) {
    const std::uint8_t* bytes = blobs.geometry.data() + 48 * i;
    lines.segments_in_map[i] = {ReadVector(bytes), ReadVector(bytes + 24)};
  }
  MAPLOC_RETURN_IF_ERROR(DecodeRest(blobs, kind, "lines", lines));
  return lines;
}

PlaceBlobs EncodePlace(const SegmentPlace& place) {
  PlaceBlobs blobs;
  blobs.count = static_cast<std::int64_t>(place.ids.size());
  blobs.row_count = static_cast<std::int64_t>(place.descriptor_landmark.size());
  blobs.reach = place.reach;
  blobs.ids = Encode<LandmarkId>(place.ids);
  blobs.row_counts = Encode<std::int32_t>(place.row_counts);
  blobs.owners = Encode<std::int32_t>(place.descriptor_landmark);
  blobs.descriptors = place.descriptors.bytes;
  blobs.checksum = ChecksumOf(blobs);
  return blobs;
}

Result<SegmentPlace> DecodePlace(PlaceBlobs blobs, const DescriptorKind& kind) {
  SegmentPlace place;
  place.reach = blobs.reach;
  MAPLOC_ASSIGN_OR_RETURN(place.ids, Decode<LandmarkId>(blobs.ids, blobs.count, "place.ids"));
  MAPLOC_ASSIGN_OR_RETURN(place.row_counts,
                          Decode<std::int32_t>(blobs.row_counts, blobs.count, "place.row_counts"));
  MAPLOC_ASSIGN_OR_RETURN(
      place.descriptor_landmark,
      Decode<std::int32_t>(blobs.owners, blobs.row_count, "place.descriptor_landmark"));
  MAPLOC_RETURN_IF_ERROR(CheckChecksum(blobs, "place"));
  // Moved, because copying the rows took a large part of the time to open a large map.
  MAPLOC_ASSIGN_OR_RETURN(
      place.descriptors,
      DecodeDescriptors(std::move(blobs.descriptors), blobs.row_count, kind, "place.descriptors"));
  if (const Status valid = ValidatePlace(kind, place); !valid.ok()) {
    return Status(StatusCode::kDataLoss, "DAMAGED_SEGMENT", valid.message());
  }
  return place;
}

}  // namespace maploc
