// The whole number that we promise: 100,000 observations by 64 robots at once.
#include "tests/contract/load/many_robots.h"

namespace maploc::testing {
namespace {

class HundredThousand : public StoreContract {};
INSTANTIATE_TEST_SUITE_P(Stores, HundredThousand,
                         ::testing::Values(StoreKind::kInMemory, StoreKind::kSqlite), NameOf);

TEST_P(HundredThousand, ObservationsByManyRobotsAreAllCountedOnce) {
  constexpr int kRobots = 64;
  constexpr int kQueriesEach = 1563;  // 100,032 together
  const MapKey key = GiveMap(*store_, "yard", 3);
  EXPECT_EQ(DriveRobots(*store_, key, kRobots, kQueriesEach, 3), 0);
  ExpectAllCountedOnce(*store_, key, kRobots, kQueriesEach, 3);
}

}  // namespace
}  // namespace maploc::testing
