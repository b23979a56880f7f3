// What an operator's probe is told, and when.
#include "server/sessions/health.h"

#include <gtest/gtest.h>

#include "tests/support/fake_clock.h"

namespace maploc {
namespace {

using namespace std::chrono_literals;

const Status kBusy(StatusCode::kUnavailable, "STORE_BUSY", "another process holds the store");
const Status kFull = ResourceExhausted("DISK_FULL", "the disk is full");

class HealthTest : public ::testing::Test {
 protected:
  // A round that takes `lasting`.
  void Run(const Status& status, std::chrono::seconds lasting = 0s) {
    health_.Run("statistics", [&] { return clock_.Advance(lasting), status; });
  }
  testing::FakeClock clock_;
  int turns_ = 0;
  Health health_{[this] { ++turns_; }, clock_};
};

TEST_F(HealthTest, AFailureIsBadAtOnceAndGoodWhenItIsOver) {
  Run(kFull);
  EXPECT_FALSE(health_.good());
  Run(kFull);
  EXPECT_EQ(turns_, 1);
  Run(Status::Ok());
  EXPECT_TRUE(health_.good());
  EXPECT_EQ(turns_, 2);
}

TEST_F(HealthTest, AStoreThatIsBusyIsBadWhenItLasts) {
  Run(kBusy, 10s);
  EXPECT_TRUE(health_.good());
  Run(kBusy, 10s);
  EXPECT_TRUE(health_.good());
  Run(kBusy, 10s);
  EXPECT_FALSE(health_.good());
  Run(Status::Ok());
  EXPECT_TRUE(health_.good());
  EXPECT_EQ(turns_, 2);
}

TEST_F(HealthTest, BusyTimesWithSuccessBetweenThemDoNotAddUp) {
  for (int i = 0; i < 10; ++i) {
    Run(kBusy, 10s);
    Run(Status::Ok());
  }
  EXPECT_EQ(turns_, 0);
}

TEST_F(HealthTest, AnotherFailureIsNotExcusedByABusyStore) {
  Run(kBusy, 10s);
  Run(kFull);
  EXPECT_FALSE(health_.good());
  Run(kBusy, 10s);  // whether the disk has room again nobody knows
  EXPECT_FALSE(health_.good());
}

TEST_F(HealthTest, PartsAreJudgedEachForItself) {
  Run(kFull);
  health_.Run("maps", [] { return Status::Ok(); });
  EXPECT_FALSE(health_.good());
  health_.Run("maps", [] { return kBusy; });
  Run(Status::Ok());
  EXPECT_TRUE(health_.good());
}

}  // namespace
}  // namespace maploc
