#include "client/odometry/tracker.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace maploc {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const PoseCovariance kCovariance = 1e-3 * PoseCovariance::Identity();

Rigid3 At(double x, double y = 0.0) { return {Eigen::Quaterniond::Identity(), {x, y, 0.0}}; }

// A robot that drives along x; the odometry's frame is the map's.
class TrackerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const double x : {0.0, 0.5, 1.0}) ASSERT_TRUE(AnswerAt(x).ok());
  }
  Result<Decision> AnswerAt(double x, double off = 0.0) {
    return tracker_.Judge(At(x), {At(x, off), kCovariance});
  }

  Tracker tracker_ = *Tracker::Create();
};

TEST_F(TrackerTest, AContradictedAnswerIsHeldBackWithItsReason) {
  const Result<Decision> decision = AnswerAt(1.5, 2.0);
  ASSERT_TRUE(decision.ok());
  EXPECT_FALSE(decision->taken());
  EXPECT_THAT(decision->Reason(),
              StartsWith("held back: odometry contradicts its position by 2.00 m ("));
  EXPECT_THAT(decision->Reason(), HasSubstr("; 1 on this place so far"));
  EXPECT_NEAR(tracker_.MapFromBase(At(1.5))->map_from_body.translation.y(), 0.0, 1e-12);
}

TEST_F(TrackerTest, EachVerdictTellsItsReason) {
  EXPECT_EQ(AnswerAt(1.5)->Reason(), "taken: odometry agrees");
  Rigid3 turned = At(2.0);
  turned.rotation = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ());
  EXPECT_THAT(tracker_.Judge(At(2.0), {turned, kCovariance})->Reason(),
              StartsWith("held back: odometry contradicts its rotation by 57.3 degrees ("));
  for (const double x : {2.5, 3.0}) ASSERT_FALSE(AnswerAt(x, 4.0)->taken());
  EXPECT_EQ(AnswerAt(3.5, 4.0)->Reason(),
            "taken: enough answers agree on a place 4.00 m and 0.0 degrees away");
  Tracker fresh = *Tracker::Create({.drift = {}, .agreeing_answers = 2});
  const auto judge = [&fresh] { return fresh.Judge(At(0.0), {At(0.0), kCovariance})->Reason(); };
  EXPECT_EQ(judge(), "held back: there is no pose yet; 1 on this place so far");
  EXPECT_EQ(judge(), "taken: enough answers agree on a first place");
}

TEST_F(TrackerTest, TheWayOfARobotThatDrivesInCirclesIsKnown) {
  const double before = tracker_.MapFromBase(At(1.0))->covariance(0, 0);
  for (const double x : {3.0, 1.0}) ASSERT_TRUE(tracker_.Advance(At(x)).ok());
  const double after = tracker_.MapFromBase(At(1.0))->covariance(0, 0);
  EXPECT_NEAR(after - before, std::pow(0.02 * 4.0, 2), 1e-9);
}

TEST_F(TrackerTest, AStandingRobotGetsNoMoreCertainThanItsAnswersAre) {
  Tracker fresh = *Tracker::Create();
  const auto judge = [&fresh](double x, double off) {
    ASSERT_TRUE(fresh.Judge(At(x), {At(x, off), kCovariance})->taken());
  };
  for (int i = 0; i < 2; ++i) ASSERT_FALSE(fresh.Judge(At(0.0), {At(0.0), kCovariance})->taken());
  for (int i = 0; i < 500; ++i) judge(0.01 * (i % 4), 0.0);  // its odometry trembles
  const UncertainPose pose = *fresh.MapFromBase(At(0.0));
  for (int i = 0; i < 6; ++i) EXPECT_GE(pose.covariance(i, i), kCovariance(i, i)) << i;
  EXPECT_LT(pose.covariance(0, 0), 2.0 * kCovariance(0, 0)) << "nor does it forget where it is";
}

TEST_F(TrackerTest, AStandingRobotIsNotDrawnToWhatItsAnswersHaveInCommon) {
  for (double x = 1.5; x < 10.0; x += 0.5) ASSERT_TRUE(AnswerAt(x)->taken());
  const auto error = [this] {
    return tracker_.MapFromBase(At(10.0))->map_from_body.translation.y();
  };
  ASSERT_TRUE(AnswerAt(10.0, 0.06)->taken());
  const double once = error();
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(AnswerAt(10.0, 0.06)->taken());
  EXPECT_NEAR(error(), once, 1e-9);
  EXPECT_LT(once, 0.03);
}

TEST_F(TrackerTest, WhatIsNoInputIsRefusedByNameAndChangesNothing) {
  const double nan = std::nan("");
  const Rigid3 doubled{Eigen::Quaterniond(2.0, 0.0, 0.0, 0.0), Eigen::Vector3d::Zero()};
  PoseCovariance skewed = kCovariance;
  skewed(0, 1) = 5e-4;
  PoseCovariance mixed = 1e10 * PoseCovariance::Identity();  // metres that hide radians
  mixed(5, 5) = -5e-3;
  const auto message = [&](const Rigid3& here, const UncertainPose& answer) {
    const Result<Decision> decision = tracker_.Judge(here, answer);
    return decision.ok() ? std::string("taken for good") : decision.status().message();
  };
  EXPECT_THAT(message(At(nan), {At(0.0), kCovariance}), StartsWith("odom_from_base: "));
  EXPECT_THAT(message(doubled, {At(0.0), kCovariance}), StartsWith("odom_from_base: "));
  EXPECT_THAT(message(At(1e200), {At(0.0), kCovariance}), StartsWith("odom_from_base: "));
  EXPECT_THAT(message(At(9.0), {At(nan), kCovariance}), StartsWith("answer.map_from_body: "));
  EXPECT_THAT(message(At(9.0), {doubled, kCovariance}), StartsWith("answer.map_from_body: "));
  for (const PoseCovariance& bad :
       {PoseCovariance(nan * kCovariance), PoseCovariance(-kCovariance),
        PoseCovariance(0.0 * kCovariance), skewed, mixed, PoseCovariance(1e300 * kCovariance)}) {
    EXPECT_THAT(message(At(9.0), {At(9.0), bad}), StartsWith("answer.covariance: "));
  }
  EXPECT_FALSE(tracker_.Advance(At(nan)).ok());
  EXPECT_EQ(tracker_.held_in_a_row(), 0);
  EXPECT_TRUE(AnswerAt(1.5)->taken());
}

TEST(TrackerOptions, BadOnesAreRefusedByName) {
  const auto message = [](const TrackerOptions& options) {
    return Tracker::Create(options).status().message();
  };
  EXPECT_THAT(message({.drift = {.at_rest = {}}}), StartsWith("drift.at_rest: "));
  EXPECT_THAT(message({.drift = {.at_rest = {1e-200, 1.0, 1.0, 1.0}}}),
              StartsWith("drift.at_rest: "));
  EXPECT_THAT(message({.drift = {.per_meter = {-1.0}}}), StartsWith("drift.per_meter: "));
  EXPECT_THAT(message({.drift = {.per_meter = {1e200}}}), StartsWith("drift.per_meter: "));
  EXPECT_THAT(message({.drift = {.per_radian = {std::nan("")}}}), StartsWith("drift.per_radian: "));
  EXPECT_THAT(message({.max_sigmas = 0.0}), StartsWith("max_sigmas: "));
  EXPECT_THAT(message({.agreeing_answers = 0}), StartsWith("agreeing_answers: "));
}

}  // namespace
}  // namespace maploc
