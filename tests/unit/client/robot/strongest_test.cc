#include "client/robot/strongest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace maploc {
namespace {

using ::testing::ElementsAre;

// Keypoint i is at x = i, with a descriptor of bytes i.
PointFeatures Points(int count) {
  PointFeatures points;
  points.descriptors.kind = *DescriptorKindFromName("binary32");
  for (int i = 0; i < count; ++i) {
    points.keypoints_px.emplace_back(i, 0);
    points.descriptors.bytes.insert(points.descriptors.bytes.end(), 32,
                                    static_cast<std::uint8_t>(i));
  }
  return points;
}

std::vector<int> Kept(int count, const std::vector<float>& scales_px, int max_features) {
  const PointFeatures kept = Strongest(Points(count), scales_px, max_features);
  std::vector<int> indices;
  EXPECT_EQ(kept.descriptors.size(), static_cast<int>(kept.keypoints_px.size()));
  for (int i = 0; i < kept.descriptors.size(); ++i) {
    indices.push_back(static_cast<int>(kept.keypoints_px[i].x()));
    EXPECT_EQ(kept.descriptors.row(i)[31], indices.back());
  }
  return indices;
}

TEST(StrongestTest, KeepsTheLargestInTheirOrderWithTheirOwnDescriptors) {
  EXPECT_THAT(Kept(5, {2, 9, 1, 5, 5}, 2), ElementsAre(1, 3));
  EXPECT_THAT(Kept(5, {2, 9, 1, 5, 5}, 3), ElementsAre(1, 3, 4));
}

TEST(StrongestTest, WithoutScalesTheyAreSpreadOverTheList) {
  EXPECT_THAT(Kept(6, {}, 3), ElementsAre(0, 2, 4));
  EXPECT_THAT(Kept(5, {}, 2), ElementsAre(0, 2));
}

TEST(StrongestTest, WhatIsNotTooManyStays) {
  EXPECT_THAT(Kept(3, {3, 2, 1}, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(Kept(0, {}, 1), ElementsAre());
}

}  // namespace
}  // namespace maploc
