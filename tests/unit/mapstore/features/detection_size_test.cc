// Photos that are too large for the detectors: reduced, and told in their own pixels.
#include "mapstore/features/detection_size.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/base/median.h"
#include "mapstore/features/features.h"
#include "mapstore/features/reduced_photo.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

GrayImage Black(int width, int height) {
  return {width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height)};
}

void Fill(GrayImage& image, int x0, int y0, int x1, int y1, std::uint8_t tone) {
  for (int y = std::max(0, y0); y < std::min(y1, image.height_px); ++y) {
    const auto row = image.pixels.begin() + static_cast<std::ptrdiff_t>(y) * image.width_px;
    std::fill(row + std::max(0, x0), row + std::clamp(x1, 0, image.width_px), tone);
  }
}

TEST(DetectionSizeTest, KeepsTheShapeAndTheBound) {
  for (const PixelSize& kept : {PixelSize{1536, 1024}, {2400, 1600}, {1600, 2400}, {1, 1}}) {
    EXPECT_EQ(DetectionSize(kept), kept);
    EXPECT_EQ(DetectionPixel(kept), 1.0);
  }
  EXPECT_EQ(DetectionSize({6000, 4000}), (PixelSize{2400, 1600}));
  EXPECT_DOUBLE_EQ(DetectionPixel({6000, 4000}), 2.5);
  for (const PixelSize& large :
       {PixelSize{2401, 1600}, {4032, 3024}, {3024, 4032}, {16384, 16384}, {16384, 235}}) {
    const PixelSize size = DetectionSize(large);
    EXPECT_LE(size.width_px * size.height_px, kMaxDetectionPixels);
    EXPECT_GT(size.width_px * size.height_px, 0.99 * kMaxDetectionPixels);
    const double pixel = DetectionPixel(large);
    EXPECT_NEAR(size.width_px * pixel, large.width_px, pixel);
    EXPECT_NEAR(size.height_px * pixel, large.height_px, pixel);
  }
}

// A side that the detectors cannot take, though the pixels are few.
TEST(DetectionSizeTest, ALongPanoramaIsReducedToTheLargestSide) {
  EXPECT_EQ(DetectionSize({32768, 100}), (PixelSize{16384, 50}));
  EXPECT_EQ(DetectionSize({100, 32768}), (PixelSize{50, 16384}));
  EXPECT_EQ(DetectionPixel({32768, 100}), 2.0);
  EXPECT_THAT(DescribeReduced(std::vector<PixelSize>{{32768, 100}}), HasSubstr("(32768x100 at"));
  EXPECT_EQ(DetectionSize({65536, 65536}).width_px, 1959);
}

TEST(DetectionSizeTest, TellsHowManyPhotosFromWhichSizeToWhich) {
  EXPECT_EQ(DescribeReduced({}), "");
  const std::vector<PixelSize> photos = {{640, 480}, {4000, 3000}, {6000, 4000}};
  EXPECT_EQ(DescribeReduced(std::span(photos).first(1)), "");
  EXPECT_THAT(DescribeReduced(photos), HasSubstr("2 of 3 photos are large"));
  EXPECT_THAT(DescribeReduced(photos), HasSubstr("(6000x4000 at 2400x1600)"));
}

// Bit for bit: what was found in smaller photos before there was a bound is found today.
TEST(ReducedPhotoTest, UpToTheBoundNothingIsTouched) {
  const GrayImage image = Black(2400, 1600);
  const ReducedPhoto photo = *ReduceForDetection(image);
  EXPECT_EQ(photo.pixels.data, image.pixels.data());
  std::vector<Eigen::Vector2f> positions = {{0.1f, 1.7f}, {1e-7f, 2399.0f}};
  const std::vector<Eigen::Vector2f> before = positions;
  photo.ToPhoto(positions);
  EXPECT_EQ(positions, before);
}

// A block whose borders fall on the reduced pixels' borders: its middle must come back exactly.
TEST(ReducedPhotoTest, APositionComesBackToItsPlaceInThePhoto) {
  GrayImage image = Black(6000, 4000);
  Fill(image, 250, 1500, 1000, 3250, 200);  // x in [249.5, 999.5], middle 624.5
  const ReducedPhoto photo = *ReduceForDetection(image);
  ASSERT_EQ(photo.pixels.size(), cv::Size(2400, 1600));
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  for (int y = 0; y < photo.pixels.rows; ++y) {
    for (int x = 0; x < photo.pixels.cols; ++x) {
      const double value = photo.pixels.at<std::uint8_t>(y, x);
      sum += value * Eigen::Vector2d(x, y);
      weight += value;
    }
  }
  std::vector<Eigen::Vector2f> positions = {(sum / weight).cast<float>(), {-0.5f, 1599.5f}};
  photo.ToPhoto(positions);
  EXPECT_LT((positions[0] - Eigen::Vector2f(624.5f, 2374.5f)).norm(), 1e-3f);
  EXPECT_LT((positions[1] - Eigen::Vector2f(-0.5f, 3999.5f)).norm(), 1e-3f) << "the outer border";
}

// Blocks of random places and tones, in a photo of twice the bound's sides and an odd pixel.
GrayImage LargePhoto() {
  Random random = testing::TestRandom();
  GrayImage image = Black(4801, 3203);
  for (int i = 0; i < 1500; ++i) {
    const int x = static_cast<int>(random.Uniform(0, 4800));
    const int y = static_cast<int>(random.Uniform(0, 3200));
    Fill(image, x, y, x + static_cast<int>(random.Uniform(20, 300)),
         y + static_cast<int>(random.Uniform(20, 300)),
         static_cast<std::uint8_t>(random.Uniform(0, 255)));
  }
  return image;
}

// Half of how much pairs of a feature and its image under half a turn miss each other: without the
// half pixel it would be half a pixel.
Eigen::Vector2d TurnBias(const std::vector<Eigen::Vector2f>& found,
                         const std::vector<Eigen::Vector2f>& turned) {
  std::vector<double> x, y;
  for (const Eigen::Vector2f& p : found) {
    for (const Eigen::Vector2f& q : turned) {
      const Eigen::Vector2f sum = p + q - Eigen::Vector2f(4800, 3202);
      if (sum.norm() > 2.5f) continue;
      x.push_back(sum.x() / 2);
      y.push_back(sum.y() / 2);
    }
  }
  EXPECT_GT(x.size(), 50u);
  return {UpperMedian(x), UpperMedian(y)};
}

float RightMost(const std::vector<Eigen::Vector2f>& positions) {
  float right = 0.0f;
  for (const Eigen::Vector2f& p : positions) right = std::max(right, p.x());
  return right;
}

TEST(LargePhotoTest, FeaturesAreBoundedAndInThePhotosOwnPixels) {
  const GrayImage image = LargePhoto();
  GrayImage turned = image;
  std::reverse(turned.pixels.begin(), turned.pixels.end());
  const DescriptorKind orb = *DescriptorKindFromName("orb");
  const auto points = DetectPoints(image, orb, {1000})->keypoints_px;
  EXPECT_LE(points.size(), 1010u);
  EXPECT_GT(RightMost(points), 4000.0f);
  EXPECT_LT(TurnBias(points, DetectPoints(turned, orb, {1000})->keypoints_px).norm(), 0.1);
  const LineFeatures lines = *DetectLines(image);
  EXPECT_LE(lines.size(), kMaxLines);
  EXPECT_GT(RightMost(lines.ends_px), 4000.0f);
  // LSD directs a line with its dark side, so that half a turn leaves starts starts.
  EXPECT_LT(TurnBias(lines.starts_px, DetectLines(turned)->starts_px).norm(), 0.2);
  const PointFeatures sift = *DetectPoints(image, *DescriptorKindFromName("sift_root_u8"), {1000});
  EXPECT_LE(sift.keypoints_px.size(), 1010u);
  EXPECT_GT(RightMost(sift.keypoints_px), 4000.0f);
}

// An edge between two of the photo's pixels, where the reduced photo has a mixed one.
TEST(LargePhotoTest, AnEdgeIsFoundWhereItIs) {
  for (const int edge : {1001, 2500, 4006}) {
    GrayImage image = Black(6000, 4000);
    Fill(image, edge, 0, 6000, 4000, 200);
    const LineFeatures lines = *DetectLines(image);
    ASSERT_GE(lines.size(), 1);
    EXPECT_NEAR(lines.starts_px[0].x(), edge - 0.5, 0.4);
    EXPECT_NEAR(lines.ends_px[0].x(), edge - 0.5, 0.4);
    EXPECT_GT(std::abs(lines.ends_px[0].y() - lines.starts_px[0].y()), 3800.0f);
  }
}

}  // namespace
}  // namespace maploc
