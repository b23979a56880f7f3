#include "server/matching/mirrored.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "mapstore/features/features.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

// Bright and dark discs of all sizes: corners and blobs without any symmetry.
GrayImage Discs(Random& random) {
  GrayImage image{400, 300, std::vector<std::uint8_t>(400 * 300, 128)};
  for (int disc = 0; disc < 300; ++disc) {
    const double x = random.Uniform(0, 400), y = random.Uniform(0, 300);
    const double radius = random.Uniform(3, 20);
    const auto gray = static_cast<std::uint8_t>(random.Below(256));
    for (int v = 0; v < 300; ++v) {
      for (int u = 0; u < 400; ++u) {
        if (std::hypot(u - x, v - y) < radius) image.pixels[v * 400 + u] = gray;
      }
    }
  }
  return image;
}

GrayImage Mirrored(GrayImage image) {
  for (int v = 0; v < image.height_px; ++v) {
    const auto row = image.pixels.begin() + static_cast<std::ptrdiff_t>(v) * image.width_px;
    std::reverse(row, row + image.width_px);
  }
  return image;
}

View ViewOf(const GrayImage& image, const char* kind) {
  const Camera camera =
      Camera::Create(CameraModel::kPinhole, 400, 300, {300, 300, 200, 150}).value();
  return {camera, {}, DetectPoints(image, DescriptorKindFromName(kind).value()).value(), {}};
}

Segment SegmentOf(const View& view) {
  Segment segment;
  segment.points.descriptors = view.points.descriptors;
  segment.points.descriptor_landmark.resize(view.points.descriptors.size());
  std::iota(segment.points.descriptor_landmark.begin(), segment.points.descriptor_landmark.end(),
            0);
  return segment;
}

class MirroredTest : public ::testing::Test {
 protected:
  Random random_ = testing::TestRandom();
  const GrayImage photo_ = Discs(random_);
};

TEST_F(MirroredTest, AMirroredPhotoIsToldForEveryKindOfSift) {
  for (const char* kind : {"sift_root_u8", "sift_u8"}) {
    const Segment segment = SegmentOf(ViewOf(photo_, kind));
    ASSERT_GT(segment.points.descriptors.size(), 100);
    EXPECT_TRUE(MatchesBetterMirrored(ViewOf(Mirrored(photo_), kind), segment)) << kind;
  }
}

TEST_F(MirroredTest, AnHonestPhotoIsNotNorOneOfAnotherPlace) {
  const Segment segment = SegmentOf(ViewOf(photo_, "sift_root_u8"));
  EXPECT_FALSE(MatchesBetterMirrored(ViewOf(photo_, "sift_root_u8"), segment));
  EXPECT_FALSE(MatchesBetterMirrored(ViewOf(Discs(random_), "sift_root_u8"), segment));
}

TEST_F(MirroredTest, NothingIsSaidOfDescriptorsThatCannotBeTurnedOver) {
  const Segment segment = SegmentOf(ViewOf(photo_, "orb"));
  EXPECT_FALSE(MatchesBetterMirrored(ViewOf(Mirrored(photo_), "orb"), segment));
}

TEST_F(MirroredTest, NothingIsSaidWithoutFeatures) {
  const Segment segment = SegmentOf(ViewOf(photo_, "sift_root_u8"));
  View empty = ViewOf(photo_, "sift_root_u8");
  empty.points.keypoints_px.clear();
  empty.points.descriptors.bytes.clear();
  EXPECT_FALSE(MatchesBetterMirrored(empty, segment));
}

}  // namespace
}  // namespace maploc
