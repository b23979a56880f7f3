// What is carried to a new version is what was there, for every cut of every map.
#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "mapstore/statistics/carry_over.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using testing::TestRandom;
using testing::TestSeed;

constexpr std::uint32_t kLandmarks = 60;

// Segments of random landmarks; with `all`, each landmark is in one at least.
std::vector<SegmentLandmarks> RandomSegments(Random& random, bool all) {
  std::vector<SegmentLandmarks> segments(1 + random.Below(5));
  for (std::size_t i = 0; i < segments.size(); ++i) segments[i].segment = static_cast<int>(i);
  for (std::uint32_t landmark = 0; landmark < kLandmarks; ++landmark) {
    const std::size_t sure = all ? random.Below(segments.size()) : segments.size();
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if (i != sure && random.Below(3) != 0) continue;
      segments[i].ids.push_back(landmark);
      segments[i].positions.emplace_back(static_cast<double>(landmark), 0.0, 0.0);
    }
  }
  std::erase_if(segments, [](const SegmentLandmarks& segment) { return segment.ids.empty(); });
  return segments;
}

SegmentSessionRow RandomRow(Random& random, SegmentId segment) {
  const auto below = [&](std::int64_t most) {
    return static_cast<std::int64_t>(random.Below(static_cast<std::uint32_t>(most + 1)));
  };
  SegmentSessionRow row;
  row.session = "s";
  row.segment = segment;
  row.queries = 1 + below(12);
  row.localized = below(row.queries);
  if (row.localized == 0) return row;
  row.point_matches = below(3000);
  row.point_inliers = below(row.point_matches);
  row.usable_line_matches = below(200);
  row.usable_line_inliers = below(row.usable_line_matches);
  row.vertical_line_matches = below(20);
  row.vertical_line_inliers = below(row.vertical_line_matches);
  row.median_point_matches = static_cast<double>(below(300)) / 7.0;
  return row;
}

using Counts = std::array<std::int64_t, 8>;

Counts SumOf(const std::vector<SegmentSessionRow>& rows) {
  Counts sum{};
  for (const SegmentSessionRow& row : rows) {
    const Counts counts = {row.queries,
                           row.localized,
                           row.point_matches,
                           row.point_inliers,
                           row.usable_line_matches,
                           row.usable_line_inliers,
                           row.vertical_line_matches,
                           row.vertical_line_inliers};
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += counts[i];
  }
  return sum;
}

void ExpectPossible(const std::vector<SegmentSessionRow>& rows) {
  for (const SegmentSessionRow& row : rows) {
    EXPECT_LE(row.localized, row.queries);
    EXPECT_LE(row.point_inliers, row.point_matches);
    EXPECT_LE(row.usable_line_inliers, row.usable_line_matches);
    EXPECT_LE(row.vertical_line_inliers, row.vertical_line_matches);
    const Counts counts = SumOf({row});
    EXPECT_GE(*std::min_element(counts.begin(), counts.end()), 0);
  }
}

TEST(CarryOverProperty, KeepsEveryCountOfWhatLivesOn) {
  for (int repetition = 0; repetition < 300; ++repetition) {
    SCOPED_TRACE(::testing::Message() << "seed " << TestSeed(repetition));
    Random random = TestRandom(repetition);
    const bool all = repetition % 2 == 0;
    const auto old_segments = RandomSegments(random, true);
    const auto new_segments = RandomSegments(random, all);
    const auto shares = CarryOver(old_segments, new_segments, 0.1);
    for (const SegmentLandmarks& segment : old_segments) {
      const std::vector<SegmentSessionRow> rows = {RandomRow(random, segment.segment)};
      const auto carried = CarryRows(rows, shares);
      ExpectPossible(carried);
      const Counts before = SumOf(rows);
      const Counts after = SumOf(carried);
      for (std::size_t i = 0; i < before.size(); ++i) {
        if (all) {
          EXPECT_EQ(after[i], before[i]) << "count " << i;
        } else {
          EXPECT_LE(after[i], before[i]) << "count " << i;
        }
      }
    }
  }
}

TEST(CarryOverProperty, OfTheSameMapChangesNoRow) {
  for (int repetition = 0; repetition < 100; ++repetition) {
    SCOPED_TRACE(::testing::Message() << "seed " << TestSeed(repetition));
    Random random = TestRandom(repetition);
    const auto segments = RandomSegments(random, false);
    std::vector<SegmentSessionRow> rows;
    for (const SegmentLandmarks& segment : segments) {
      rows.push_back(RandomRow(random, segment.segment));
    }
    EXPECT_EQ(CarryRows(rows, CarryOver(segments, segments, 0.1)), rows);
  }
}

}  // namespace
}  // namespace maploc
