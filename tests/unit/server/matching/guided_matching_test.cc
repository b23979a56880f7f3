#include "server/matching/guided_matching.h"

#include <gmock/gmock.h>

#include "tests/support/seed.h"

namespace maploc {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kRadiusPx = 5.0;
const DescriptorKind kKind{"orb", 32, DescriptorMetric::kHamming};

// Landmarks 10 m in front of a camera at the map's origin, and what is seen of them. The first one
// is seen as it is and known: its descriptors differ by kKnownBits.
class GuidedMatchingTest : public ::testing::Test {
 protected:
  static constexpr int kKnownBits = 20;

  GuidedMatchingTest() {
    view_.points.descriptors.kind = kKind;
    segment_.points.descriptors.kind = kKind;
    AddLandmark({100, 100});
    See(0, {100, 100}, kKnownBits);
  }

  std::vector<std::uint8_t> RandomRow() {
    std::vector<std::uint8_t> row(kKind.bytes);
    for (std::uint8_t& byte : row) byte = static_cast<std::uint8_t>(random_.Below(256));
    return row;
  }

  // Where the camera sees it, and as far in front of it.
  void AddLandmark(const Eigen::Vector2d& pixel, double depth = 10.0) {
    const Eigen::Vector2d normalized = *view_.camera.Normalize(pixel);
    PointLandmarks& points = segment_.points;
    points.ids.push_back(points.size());
    points.positions_in_map.push_back(depth * normalized.homogeneous());
    AddRow(RandomRow());
  }

  // One more row of the last landmark.
  void AddRow(const std::vector<std::uint8_t>& row) {
    PointLandmarks& points = segment_.points;
    points.descriptors.bytes.insert(points.descriptors.bytes.end(), row.begin(), row.end());
    points.descriptor_landmark.push_back(points.size() - 1);
  }

  // A feature that looks like row `row` but for the first `bits` bits.
  void See(int row, const Eigen::Vector2f& pixel, int bits) {
    const auto from = segment_.points.descriptors.row(row);
    std::vector<std::uint8_t> bytes(from.begin(), from.end());
    for (int i = 0; i < bits; ++i) bytes[i / 8] ^= 1 << i % 8;
    view_.points.keypoints_px.push_back(pixel);
    auto& all = view_.points.descriptors.bytes;
    all.insert(all.end(), bytes.begin(), bytes.end());
  }

  std::vector<std::pair<int, int>> Match(double radius_px = kRadiusPx) {
    const std::vector<FeatureMatch> known = {{0, 0, 0.5f}};
    const std::vector<std::uint8_t> inlier = {1};
    std::vector<std::pair<int, int>> pairs;
    for (const FeatureMatch& match :
         MatchNearProjections(view_, segment_, Rigid3(), radius_px, known, inlier)) {
      pairs.emplace_back(match.feature, match.landmark);
    }
    return pairs;
  }

  Random random_ = testing::TestRandom();
  View view_{
      Camera::Create(CameraModel::kPinhole, 640, 480, {500, 500, 320, 240}).value(), {}, {}, {}};
  Segment segment_;
};

TEST_F(GuidedMatchingTest, FindsWhatIsNearAndSimilar) {
  AddLandmark({300, 200});
  See(1, {303, 203}, kKnownBits);
  EXPECT_THAT(Match(), ElementsAre(std::pair(1, 1)));
}

TEST_F(GuidedMatchingTest, WhatIsKnownIsLeftOut) {
  See(0, {101, 101}, 0);  // landmark 0 has its match
  AddLandmark({100, 102});
  segment_.points.descriptors.bytes.resize(32);
  segment_.points.descriptors.bytes.insert(segment_.points.descriptors.bytes.end(),
                                           view_.points.descriptors.bytes.begin(),
                                           view_.points.descriptors.bytes.begin() + 32);
  EXPECT_THAT(Match(), ElementsAre(std::pair(1, 1)));  // and feature 0 its own
}

TEST_F(GuidedMatchingTest, ATwinElsewhereInTheImageDoesNotDisturb) {
  AddLandmark({300, 200});
  See(1, {300, 201}, kKnownBits);
  See(1, {500, 400}, 0);
  EXPECT_THAT(Match(), ElementsAre(std::pair(1, 1)));
}

TEST_F(GuidedMatchingTest, WhatIsFartherOrLessSimilarIsNoMatch) {
  AddLandmark({300, 200});
  See(1, {304, 204}, 0);  // 5.7 px
  AddLandmark({400, 300});
  See(2, {400, 300}, kKnownBits + 1);
  EXPECT_THAT(Match(), IsEmpty());
}

TEST_F(GuidedMatchingTest, OfSeveralTheNearestOfEachOther) {
  AddLandmark({300, 200});
  See(1, {300, 200}, 15);
  See(1, {302, 200}, 5);
  AddLandmark({303, 200});
  See(2, {301, 200}, 10);
  EXPECT_THAT(Match(), ElementsAre(std::pair(2, 1), std::pair(3, 2)));
}

TEST_F(GuidedMatchingTest, AnyRowOfALandmarkCounts) {
  AddLandmark({300, 200});
  AddRow(RandomRow());
  See(2, {300, 200}, 3);
  EXPECT_THAT(Match(), ElementsAre(std::pair(1, 1)));
}

TEST_F(GuidedMatchingTest, LandmarksBehindTheCameraAndBesideTheImageHaveNone) {
  AddLandmark({300, 200}, -10.0);
  See(1, {300, 200}, 0);
  See(1, {340, 280}, 0);
  AddLandmark({-50, 200});
  See(2, {2, 200}, 0);
  EXPECT_THAT(Match(), IsEmpty());
}

TEST_F(GuidedMatchingTest, ASmallRadiusInALargeImageNeedsNoLargeGrid) {
  view_.camera =
      Camera::Create(CameraModel::kPinhole, 65536, 65536, {50000, 50000, 32768, 32768}).value();
  AddLandmark({65000, 65000});
  See(1, {65000, 65000}, 0);
  See(1, {65001, 65000}, 0);
  EXPECT_THAT(Match(0.1), ElementsAre(std::pair(1, 1)));
}

// Keypoints that stand outside of the image, or on its very border.
TEST_F(GuidedMatchingTest, TheBorderIsSearchedAndWhatIsBeyondIsNot) {
  AddLandmark({639.5, 479.5});
  See(1, {640, 480}, 0);
  AddLandmark({1, 1});
  See(2, {-3, -3}, 0);
  See(2, {1e6f, -1e6f}, 0);
  EXPECT_THAT(Match(), ElementsAre(std::pair(1, 1)));
}

}  // namespace
}  // namespace maploc
