// Against the definition: all others sorted by distance and value.
#include "mapstore/statistics/references.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <utility>

#include <gmock/gmock.h>

#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

enum class Side { kBoth, kEarlier, kLater };

bool IsOn(Side side, std::int64_t time, std::int64_t now) {
  return side == Side::kBoth || (side == Side::kEarlier) == (time < now);
}

std::vector<double> ByDefinition(std::span<const TimedValue> all, const TimedValue& of,
                                 std::size_t most, Side side) {
  std::vector<std::pair<std::int64_t, double>> others;
  for (const TimedValue& other : all) {
    if (other.robot == of.robot || !IsOn(side, other.start_unix_ns, of.start_unix_ns)) continue;
    others.emplace_back(std::abs(other.start_unix_ns - of.start_unix_ns), other.value);
  }
  std::sort(others.begin(), others.end());
  others.resize(std::min(others.size(), most));
  std::vector<double> values;
  for (const auto& [distance, value] : others) values.push_back(value);
  return values;
}

// Few moments and few values, so that many are equally near and equally good; some fleets are
// mostly one robot's.
std::vector<TimedValue> RandomFleet(Random& random) {
  const std::uint32_t sessions = 1 + random.Below(60);
  const std::uint32_t robots = 1 + random.Below(6);
  const std::uint32_t moments = 1 + random.Below(100);
  const double share_of_first = random.Uniform();
  std::vector<TimedValue> fleet;
  for (std::uint32_t i = 0; i < sessions; ++i) {
    const std::size_t robot = random.Uniform() < share_of_first ? 0u : random.Below(robots);
    fleet.push_back({static_cast<std::int64_t>(random.Below(moments)),
                     0.1 * static_cast<double>(random.Below(11)), robot});
  }
  return fleet;
}

TEST(SegmentReferences, AreThoseOfTheDefinition) {
  for (int repetition = 0; repetition < 2000; ++repetition) {
    Random random = TestRandom(repetition);
    const std::vector<TimedValue> fleet = RandomFleet(random);
    const SegmentReferences references(fleet);
    const std::size_t most = random.Below(13);
    const auto limit = static_cast<std::int64_t>(most);
    SCOPED_TRACE(TestSeed(repetition));
    for (const TimedValue& of : fleet) {
      const std::int64_t now = of.start_unix_ns;
      ASSERT_EQ(references.Nearest(now, of.robot, limit),
                ByDefinition(fleet, of, most, Side::kBoth));
      ASSERT_EQ(references.Earlier(now, of.robot, limit),
                ByDefinition(fleet, of, most, Side::kEarlier));
      ASSERT_EQ(references.Later(now, of.robot, limit),
                ByDefinition(fleet, of, most, Side::kLater));
    }
  }
}

TEST(SegmentReferences, ReachFromTheFirstMomentToTheLast) {
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  const SegmentReferences references(
      std::vector<TimedValue>{{kFirst, 0.1, 0}, {kLast, 0.2, 1}, {0, 0.3, 2}});
  EXPECT_THAT(references.Nearest(kFirst, 0, 10), ElementsAre(0.3, 0.2));
  EXPECT_THAT(references.Nearest(kLast, 1, 10), ElementsAre(0.3, 0.1));
  EXPECT_THAT(references.Earlier(kLast, 1, 10), ElementsAre(0.3, 0.1));
  EXPECT_THAT(references.Later(kFirst, 0, 10), ElementsAre(0.3, 0.2));
}

TEST(SegmentReferences, NeedAnotherRobot) {
  const SegmentReferences references(std::vector<TimedValue>{{1, 0.1, 7}, {2, 0.2, 7}});
  EXPECT_THAT(references.Nearest(1, 7, 10), IsEmpty());
  EXPECT_THAT(SegmentReferences({}).Nearest(1, 7, 10), IsEmpty());
}

}  // namespace
}  // namespace maploc::testing
