#include "mapstore/features/features.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/base/median.h"
#include "tests/support/files.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

// Grey rectangles of random places, sizes and tones on a grey ground, soft as a lens makes them:
// corners, blobs and edges. The same image when turned by 180 degrees by Turn.
GrayImage MakeImage(Random random, int width, int height, int rectangles) {
  std::vector<double> canvas(static_cast<std::size_t>(width * height), 128.0);
  for (int i = 0; i < rectangles; ++i) {
    const double x0 = random.Uniform(0, width), y0 = random.Uniform(0, height);
    const double x1 = x0 + random.Uniform(6, 90), y1 = y0 + random.Uniform(6, 90);
    const double tone = random.Uniform(0, 255);
    for (int y = std::max(0, static_cast<int>(y0)); y < std::min<int>(height, static_cast<int>(y1));
         ++y) {
      for (int x = std::max(0, static_cast<int>(x0));
           x < std::min<int>(width, static_cast<int>(x1)); ++x) {
        canvas[static_cast<std::size_t>(y * width + x)] = tone;
      }
    }
  }
  GrayImage image{width, height, {}};
  const auto at = [&](int x, int y) {
    x = std::clamp(x, 0, width - 1);
    y = std::clamp(y, 0, height - 1);
    return canvas[static_cast<std::size_t>(y * width + x)];
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx)
          sum += at(x + dx, y + dy) * (2 - std::abs(dx)) * (2 - std::abs(dy));
      }
      image.pixels.push_back(static_cast<std::uint8_t>(sum / 16));
    }
  }
  return image;
}

GrayImage Turn(GrayImage image) {
  std::reverse(image.pixels.begin(), image.pixels.end());
  return image;
}

class PixelConventionTest : public ::testing::TestWithParam<const char*> {};

TEST_P(PixelConventionTest, HalfATurnOfTheImageHalfTurnsTheKeypoints) {
  const GrayImage image = MakeImage(testing::TestRandom(), 500, 401, 150);
  const DescriptorKind kind = *DescriptorKindFromName(GetParam());
  const auto keypoints = DetectPoints(image, kind)->keypoints_px;
  const auto turned = DetectPoints(Turn(image), kind)->keypoints_px;
  std::vector<double> bias_x, bias_y;
  for (const Eigen::Vector2f& p : keypoints) {
    for (const Eigen::Vector2f& q : turned) {
      const Eigen::Vector2f sum = p + q - Eigen::Vector2f(499, 400);
      if (sum.norm() > 1.0f) continue;
      bias_x.push_back(sum.x() / 2);
      bias_y.push_back(sum.y() / 2);
    }
  }
  ASSERT_GT(bias_x.size(), 50u);
  EXPECT_NEAR(UpperMedian(bias_x), 0.0, 0.03);
  EXPECT_NEAR(UpperMedian(bias_y), 0.0, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Kinds, PixelConventionTest,
                         ::testing::Values("orb", "sift_root_u8", "sift_u8"));

// Dark left of x = edge + slope y, with the edge's pixel a mix of both tones by its covered area.
GrayImage MakeEdge(double edge, bool vertical) {
  GrayImage image{200, 200, {}};
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double dark = std::clamp(edge - (vertical ? x : y) + 0.5, 0.0, 1.0);
      image.pixels.push_back(static_cast<std::uint8_t>(std::lround(200 - 150 * dark)));
    }
  }
  return image;
}

TEST(DetectLinesTest, FindsAnEdgeWhereItIs) {
  for (const double edge : {60.5, 93.0, 120.25}) {
    const LineFeatures vertical = *DetectLines(MakeEdge(edge, true));
    ASSERT_GE(vertical.size(), 1);
    EXPECT_NEAR(vertical.starts_px[0].x(), edge, 0.15);
    EXPECT_NEAR(vertical.ends_px[0].x(), edge, 0.15);
    const LineFeatures level = *DetectLines(MakeEdge(edge, false));
    ASSERT_GE(level.size(), 1);
    EXPECT_NEAR(level.starts_px[0].y(), edge, 0.15);
    EXPECT_NEAR(level.ends_px[0].y(), edge, 0.15);
  }
}

TEST(DetectLinesTest, LongestFirstAndInsideTheImage) {
  const GrayImage image = MakeImage(testing::TestRandom(), 500, 401, 150);
  const LineFeatures lines = *DetectLines(image);
  ASSERT_GE(lines.size(), 25);
  ASSERT_LE(lines.size(), kMaxLines);
  ASSERT_EQ(lines.descriptors.size(), lines.size());
  EXPECT_EQ(lines.descriptors.kind.name, "lbd");
  float last = 1e9f;
  for (std::size_t i = 0; i < lines.starts_px.size(); ++i) {
    const float length = (lines.ends_px[i] - lines.starts_px[i]).norm();
    EXPECT_LE(length, last + 1e-4f);  // the last digits of two equal lengths
    EXPECT_GE(length, kMinLineLengthPx);
    last = length;
    for (const Eigen::Vector2f& p : {lines.starts_px[i], lines.ends_px[i]}) {
      EXPECT_TRUE(p.x() >= 0 && p.y() >= 0 && p.x() <= 499 && p.y() <= 400);
    }
  }
}

TEST(DetectPointsTest, NoMoreThanAskedAndOneDescriptorEach) {
  const GrayImage image = MakeImage(testing::TestRandom(), 500, 401, 150);
  for (const char* name : {"orb", "sift_root_u8"}) {
    const PointFeatures points = *DetectPoints(image, *DescriptorKindFromName(name), {60});
    EXPECT_LE(points.keypoints_px.size(), 70u);  // OpenCV keeps ties of the weakest
    EXPECT_EQ(points.descriptors.size(), static_cast<int>(points.keypoints_px.size()));
    EXPECT_EQ(points.descriptors.kind.name, name);
  }
}

TEST(DetectTest, TinyThinAndEmptyImagesAreNoTrouble) {
  Random random = testing::TestRandom();
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{
           {1, 1}, {2, 3}, {16, 16}, {31, 400}, {33, 33}, {400, 33}, {64, 64}}) {
    GrayImage noise{width, height, {}};
    for (int i = 0; i < width * height; ++i) {
      noise.pixels.push_back(static_cast<std::uint8_t>(random.Below(256)));
    }
    const GrayImage flat{width, height,
                         std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), 7)};
    for (const GrayImage& image : {noise, flat, MakeImage(random, width, height, 8)}) {
      EXPECT_TRUE(DetectLines(image).ok());
      for (const char* name : {"orb", "sift_u8"}) {
        EXPECT_TRUE(DetectPoints(image, *DescriptorKindFromName(name)).ok())
            << width << " " << name;
      }
    }
  }
}

TEST(DetectTest, APanoramaOfAnyWidthIsReduced) {
  const GrayImage image = MakeImage(testing::TestRandom(), 20000, 150, 300);
  const PointFeatures points = *DetectPoints(image, *DescriptorKindFromName("orb"));
  const LineFeatures lines = *DetectLines(image);
  ASSERT_GT(points.keypoints_px.size(), 100u);
  ASSERT_GT(lines.size(), 100);
  const auto right = [](const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
    return a.x() < b.x();
  };
  EXPECT_GT(std::ranges::max(points.keypoints_px, right).x(), 17000.0f);
  EXPECT_GT(std::ranges::max(lines.ends_px, right).x(), 17000.0f);
}

TEST(DetectTest, RefusesWhatIsNoImageAndWhatItCannotExtract) {
  const GrayImage lying{100, 100, std::vector<std::uint8_t>(99)};
  EXPECT_EQ(DetectLines(lying).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(DetectPoints(lying, *DescriptorKindFromName("orb")).status().code(),
            StatusCode::kInvalidArgument);
  const GrayImage image = MakeImage(testing::TestRandom(), 64, 64, 5);
  EXPECT_EQ(DetectPoints(image, *DescriptorKindFromName("binary48")).status().code(),
            StatusCode::kUnimplemented);
}

TEST(DetectTest, TheSameFromEveryThread) {
  const GrayImage image = MakeImage(testing::TestRandom(), 400, 300, 100);
  const DescriptorKind kind = *DescriptorKindFromName("sift_root_u8");
  const PointFeatures points = *DetectPoints(image, kind);
  const LineFeatures lines = *DetectLines(image);
  std::vector<std::jthread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&] {
      EXPECT_EQ(DetectPoints(image, kind)->descriptors.bytes, points.descriptors.bytes);
      EXPECT_EQ(DetectLines(image)->descriptors.bytes, lines.descriptors.bytes);
    });
  }
}

}  // namespace
}  // namespace maploc
