// Landmarks as bytes, little-endian on every machine, and back: FORMAT.md, "Blobs". Decoding trusts
// nothing: lengths must fit counts, and the checksum must fit the bytes. Pure functions.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "mapstore/base/status.h"
#include "mapstore/descriptors/segment_place.h"
#include "mapstore/model/map.h"

namespace maploc {

using Blob = std::vector<std::uint8_t>;

// All of a segment's points, or all of its lines.
struct FeatureBlobs {
  std::int64_t count = 0;             // landmarks
  std::int64_t descriptor_count = 0;  // rows
  Blob ids;                           // int64 a landmark
  Blob geometry;     // float64: a point's x, y, z; a line's start x, y, z, end x, y, z
  Blob owners;       // int32 a descriptor row: index of its landmark
  Blob descriptors;  // rows of the map's kind
  // float32 direction x, y, z, angle, min and max distance a landmark; empty: not known
  Blob viewing;
  std::uint64_t checksum = 0;  // ChecksumOf
};

// FNV-1a of the five blobs, one after the other. An empty one changes nothing, so that what was
// written before there was `viewing` still fits.
std::uint64_t ChecksumOf(const FeatureBlobs& blobs);

// A segment's place, without its path.
struct PlaceBlobs {
  std::int64_t count = 0;      // landmarks
  std::int64_t row_count = 0;  // of `descriptors`
  double reach = 0.0;
  Blob ids;                    // int64 a landmark
  Blob row_counts;             // int32 a landmark: its rows in the segment
  Blob owners;                 // int32 a row: index of its landmark
  Blob descriptors;            // rows of the map's kind
  std::uint64_t checksum = 0;  // ChecksumOf
};

// FNV-1a of the four blobs and the reach (float64), one after the other.
std::uint64_t ChecksumOf(const PlaceBlobs& blobs);

FeatureBlobs EncodePoints(const PointLandmarks& points);
FeatureBlobs EncodeLines(const LineLandmarks& lines);
// `kind` is the map's. DATA_LOSS (DAMAGED_SEGMENT) names the blob.
Result<PointLandmarks> DecodePoints(const FeatureBlobs& blobs, const DescriptorKind& kind);
Result<LineLandmarks> DecodeLines(const FeatureBlobs& blobs, const DescriptorKind& kind);

PlaceBlobs EncodePlace(const SegmentPlace& place);
// Without id and path. DATA_LOSS (DAMAGED_SEGMENT) names the blob.
Result<SegmentPlace> DecodePlace(PlaceBlobs blobs, const DescriptorKind& kind);

// float64 x, y, z a position.
Blob EncodePositions(std::span<const Eigen::Vector3d> positions);
Result<std::vector<Eigen::Vector3d>> DecodePositions(std::span<const std::uint8_t> bytes,
                                                     std::int64_t count, std::string_view field);

}  // namespace maploc
