#include "mapstore/store/codec.h"

#include <limits>

#include <gmock/gmock.h>

#include "mapstore/base/random.h"
#include "tests/contract/store/store_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The bytes themselves, as FORMAT.md gives them: a store moves between machines.
TEST(Codec, IsLittleEndian) {
  PointLandmarks points;
  points.ids = {0x0102030405060708};
  points.positions_in_map = {{1.0, -2.0, 0.0}};
  points.descriptor_landmark = {0};
  points.descriptors.kind = DescriptorKindFromName("binary2").value();
  points.descriptors.bytes = {0xab, 0xcd};
  const FeatureBlobs blobs = EncodePoints(points);
  EXPECT_THAT(blobs.ids, ElementsAre(8, 7, 6, 5, 4, 3, 2, 1));
  EXPECT_THAT(blobs.geometry, ElementsAre(0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0xc0,
                                          0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(blobs.owners, ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(blobs.descriptors, ElementsAre(0xab, 0xcd));
}

TEST(Codec, BringsBackEveryBit) {
  PointLandmarks points;
  points.ids = {-5, std::numeric_limits<std::int64_t>::max()};
  points.positions_in_map = {{1.0 / 3.0, -0.0, 1e-310}, {1e300, -7.25, 0.1}};
  const auto decoded = DecodePoints(EncodePoints(points), DescriptorKind{});
  ASSERT_TRUE(decoded.ok()) << decoded.status().ToString();
  EXPECT_EQ(decoded->ids, points.ids);
  EXPECT_EQ(decoded->positions_in_map, points.positions_in_map);
  EXPECT_TRUE(std::signbit(decoded->positions_in_map[0].y()));
}

TEST(Codec, BringsBackFromWhereLandmarksWereSeen) {
  const Segment segment = SeenYardSegment(1);
  const FeatureBlobs points = EncodePoints(segment.points);
  EXPECT_EQ(points.viewing.size(), 120u * 24u);
  const auto decoded = DecodePoints(points, segment.points.descriptors.kind);
  ASSERT_TRUE(decoded.ok()) << decoded.status().ToString();
  EXPECT_EQ(decoded->viewing, segment.points.viewing);
  const auto lines = DecodeLines(EncodeLines(segment.lines), segment.lines.descriptors.kind);
  ASSERT_TRUE(lines.ok()) << lines.status().ToString();
  EXPECT_EQ(lines->viewing, segment.lines.viewing);
}

// Of before schema version 5: what was written then must still fit.
TEST(Codec, NothingKnownChangesNoChecksum) {
  const FeatureBlobs blobs = EncodePoints(YardSegment(1).points);
  EXPECT_TRUE(blobs.viewing.empty());
  std::uint64_t hash = HashBytes({});
  for (const Blob* blob : {&blobs.ids, &blobs.geometry, &blobs.owners, &blobs.descriptors}) {
    hash = HashBytes({reinterpret_cast<const char*>(blob->data()), blob->size()}, hash);
  }
  EXPECT_EQ(blobs.checksum, hash);
}

TEST(Codec, NamesTheBlobThatDoesNotFit) {
  const DescriptorKind kind = YardInfo().point_descriptor;
  const FeatureBlobs good = EncodePoints(SeenYardSegment(0).points);
  const auto expect_named = [&](Blob FeatureBlobs::*blob, const std::string& name) {
    FeatureBlobs shorter = good;
    (shorter.*blob).pop_back();
    const Status status = DecodePoints(shorter, kind).status();
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(), HasSubstr(name));
  };
  expect_named(&FeatureBlobs::ids, "points.ids");
  expect_named(&FeatureBlobs::geometry, "points.positions");
  expect_named(&FeatureBlobs::owners, "points.descriptor_landmark");
  expect_named(&FeatureBlobs::descriptors, "points.descriptors");
  expect_named(&FeatureBlobs::viewing, "points.viewing");
  FeatureBlobs negative = good;
  negative.count = -1;
  EXPECT_EQ(DecodePoints(negative, kind).status().code(), StatusCode::kDataLoss);
  FeatureBlobs flipped = good;
  flipped.geometry[5] ^= 1;
  EXPECT_THAT(DecodePoints(flipped, kind).status().message(), HasSubstr("checksum"));
  flipped = good;
  flipped.viewing[5] ^= 1;
  EXPECT_THAT(DecodePoints(flipped, kind).status().message(), HasSubstr("checksum"));
  FeatureBlobs gone = good;
  gone.viewing.clear();
  EXPECT_THAT(DecodePoints(gone, kind).status().message(), HasSubstr("checksum"));
}

}  // namespace
}  // namespace maploc::testing
