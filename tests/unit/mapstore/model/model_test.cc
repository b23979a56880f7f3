#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/model/descriptor.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/map.h"
#include "mapstore/model/strategy.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

TEST(DescriptorKindTest, KnownNamesSayLengthAndMetric) {
  EXPECT_EQ(DescriptorKindFromName("orb")->bytes, 32);
  EXPECT_EQ(DescriptorKindFromName("sift_root_u8")->metric, DescriptorMetric::kL2U8);
  EXPECT_EQ(DescriptorKindFromName("binary48")->bytes, 48);
  EXPECT_EQ(DescriptorKindFromName("binary48")->metric, DescriptorMetric::kHamming);
  EXPECT_EQ(DescriptorKindFromName("unit256")->bytes, 256);
  EXPECT_EQ(DescriptorKindFromName("unit256")->metric, DescriptorMetric::kL2U8);
}

TEST(DescriptorKindTest, RefusesOthersAndSaysWhichAreKnown) {
  for (const char* name : {"", "surf", "binary", "binary0", "binary513", "binary-1", "binary48x",
                           "binary99999999999999999999", "unit", "unit15", "unit513"}) {
    const auto kind = DescriptorKindFromName(name);
    ASSERT_FALSE(kind.ok()) << name;
    EXPECT_THAT(kind.status().message(), HasSubstr("sift_root_u8")) << name;
  }
}

// By hand: (0.6, -0.8, 0, ...) / 1 is 128 + 153.6 and 128 - 204.8, cut at both ends.
TEST(FromUnitVectorsTest, ScalesRoundsAndCuts) {
  std::vector<float> rows(32, 0.0f);
  rows[0] = 0.6f;
  rows[1] = -0.8f;
  std::fill(rows.begin() + 16, rows.end(), -3.0f);  // each a quarter of the length
  const auto made = FromUnitVectors(rows, 16);
  ASSERT_TRUE(made.ok()) << made.status().ToString();
  EXPECT_EQ(made->kind.name, "unit16");
  ASSERT_EQ(made->size(), 2);
  EXPECT_EQ(made->row(0)[0], 255);
  EXPECT_EQ(made->row(0)[1], 0);
  EXPECT_EQ(made->row(0)[2], 128);
  for (const std::uint8_t byte : made->row(1)) EXPECT_EQ(byte, 64);
}

TEST(FromUnitVectorsTest, RefusesWhatHasNoDirectionAndNamesItsRow) {
  for (const float value : {0.0f, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    std::vector<float> rows(48, 1.0f);
    std::fill(rows.begin() + 32, rows.end(), value);
    EXPECT_THAT(FromUnitVectors(rows, 16).status().message(), HasSubstr("row 2 "));
  }
  EXPECT_THAT(FromUnitVectors(std::vector<float>(8, 1.0f), 8).status().message(),
              HasSubstr("'unit8' is unknown"));
}

// The order of distances is what matching lives on: bytes keep those of the floats within 1%.
TEST(FromUnitVectorsTest, KeepsTheDistancesOfTheFloats) {
  Random random = testing::TestRandom();
  SCOPED_TRACE(::testing::Message() << "seed " << testing::TestSeed());
  for (const int elements : {64, 128, 256}) {
    std::vector<float> rows;
    for (int i = 0; i < 40 * elements; ++i) rows.push_back(static_cast<float>(random.Gaussian()));
    const Descriptors bytes = FromUnitVectors(rows, elements).value();
    EXPECT_TRUE(CheckScale(bytes, "made").ok());
    for (int i = 1; i < 40; ++i) {
      const Eigen::Map<const Eigen::VectorXf> a(rows.data(), elements);
      const Eigen::Map<const Eigen::VectorXf> b(rows.data() + i * elements, elements);
      const double want = 256.0 * (a.normalized() - b.normalized()).norm();
      double squares = 0.0;
      for (int k = 0; k < elements; ++k) squares += std::pow(bytes.row(0)[k] - bytes.row(i)[k], 2);
      EXPECT_NEAR(std::sqrt(squares), want, 0.01 * want);
    }
  }
}

TEST(NamesTest, OutcomesHaveNamesOfTheirOwn) {
  std::set<std::string_view> names = {OutcomeName(static_cast<Outcome>(0))};  // "UNKNOWN"
  for (int i = 1; i <= 7; ++i) {
    EXPECT_TRUE(names.insert(OutcomeName(static_cast<Outcome>(i))).second) << i;
  }
}

TEST(NamesTest, EveryNameReadsBack) {
  for (int i = 1; i <= 4; ++i) {
    const Strategy strategy = static_cast<Strategy>(i);
    EXPECT_EQ(StrategyFromName(StrategyName(strategy)), strategy);
  }
  EXPECT_EQ(RefinementFromName("auto"), Refinement::kAuto);
  EXPECT_FALSE(StrategyFromName("3p").has_value());
}

class SegmentTest : public ::testing::Test {
 protected:
  SegmentTest() {
    map_.point_descriptor = DescriptorKindFromName("binary2").value();
    map_.line_descriptor = DescriptorKindFromName("binary1").value();
    segment_.points.ids = {3, 8};
    segment_.points.positions_in_map = {{0, 0, 0}, {1, 2, 3}};
    segment_.points.descriptors = {map_.point_descriptor, {1, 2, 3, 4, 5, 6}};
    segment_.points.descriptor_landmark = {0, 0, 1};
    segment_.lines.ids = {5, 6};
    segment_.lines.segments_in_map = {{{0, 0, 0}, {0, 0, 2}}, {{0, 0, 0}, {1, 0, 0}}};
    segment_.lines.descriptors = {map_.line_descriptor, {1, 2}};
    segment_.lines.descriptor_landmark = {0, 1};
  }

  void ExpectRefused(const std::string& field) {
    const Status status = ValidateSegment(map_, segment_);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr(field));
  }

  MapInfo map_;
  Segment segment_;
};

TEST_F(SegmentTest, AValidOnePasses) {
  EXPECT_TRUE(ValidateSegment(map_, segment_).ok());
  EXPECT_EQ(CountUsableLines(segment_.lines), 1);
  EXPECT_TRUE(ValidateSegment(map_, Segment{}).ok()) << "an empty segment of a map with kinds";
}

TEST_F(SegmentTest, NamesTheFieldThatIsWrong) {
  const Segment good = segment_;
  segment_.points.ids = {8, 8};
  ExpectRefused("points.ids[1]");
  segment_ = good;
  segment_.points.positions_in_map[1].y() = std::numeric_limits<double>::infinity();
  ExpectRefused("points.positions_in_map[1]");
  segment_ = good;
  segment_.points.positions_in_map.pop_back();
  ExpectRefused("points.positions_in_map");
  segment_ = good;
  segment_.points.descriptors.bytes.pop_back();
  ExpectRefused("points.descriptors");
  segment_ = good;
  segment_.points.descriptor_landmark = {0, 0, 2};
  ExpectRefused("points.descriptor_landmark[2]");
  segment_ = good;
  segment_.points.descriptor_landmark = {1, 0, 1};
  ExpectRefused("points.descriptor_landmark[1]");
  segment_ = good;
  segment_.points.descriptors.kind = map_.line_descriptor;
  ExpectRefused("differs from the map's");
  segment_ = good;
  segment_.lines.segments_in_map[0].end = segment_.lines.segments_in_map[0].start;
  ExpectRefused("lines.segments_in_map[0]");
}

TEST_F(SegmentTest, WhereLandmarksWereSeenMayBeKnownOrNot) {
  segment_.points.viewing = {ViewingRange{}, {{0, 0.6f, 0.8f}, 0.5f, 1, 2}};
  segment_.lines.viewing = {{{1, 0, 0}, 0, 0, 0}, ViewingRange{}};
  EXPECT_TRUE(ValidateSegment(map_, segment_).ok());
}

TEST_F(SegmentTest, NamesTheViewThatIsWrong) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto expect_refused = [this](const ViewingRange& range) {
    segment_.points.viewing = {ViewingRange{}, range};
    ExpectRefused("points.viewing[1]");
  };
  expect_refused({{0, 0, 0.9f}, 0.5f, 1, 2});
  expect_refused({{kNan, 0, 1}, 0.5f, 1, 2});
  expect_refused({{0, 0, 1}, -0.1f, 1, 2});
  expect_refused({{0, 0, 1}, 3.2f, 1, 2});
  expect_refused({{0, 0, 1}, kNan, 1, 2});
  expect_refused({{0, 0, 1}, 0.5f, -1, 2});
  expect_refused({{0, 0, 1}, 0.5f, 3, 2});
  expect_refused({{0, 0, 1}, 0.5f, 1, std::numeric_limits<float>::infinity()});
  segment_.points.viewing = {ViewingRange{}};
  ExpectRefused("points.viewing");
  segment_.points.viewing.clear();
  segment_.lines.viewing = {{{0, 0, 2}, 0, 0, 0}, ViewingRange{}};
  ExpectRefused("lines.viewing[0]");
}

TEST(StrategyTest, VerticalLinesAreDrawnWhereTheyHelp) {
  EXPECT_TRUE(DrawsVerticalLines(Strategy::kMixed, 30, 31));
  EXPECT_FALSE(DrawsVerticalLines(Strategy::kMixed, 30, 30));
  EXPECT_FALSE(DrawsVerticalLines(Strategy::kMixed, 0, 1)) << "a vertical line asks for another";
  EXPECT_TRUE(DrawsVerticalLines(Strategy::k1P1L, 9, 50));
  EXPECT_FALSE(DrawsVerticalLines(Strategy::k1P1L, 10, 50)) << "usable ones are enough";
  EXPECT_FALSE(DrawsVerticalLines(Strategy::k2P, 0, 50));
  EXPECT_FALSE(DrawsVerticalLines(Strategy::kP3P, 0, 50));
}

}  // namespace
}  // namespace maploc
