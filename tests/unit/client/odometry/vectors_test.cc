// The vectors that the Python package passes too (make_vectors.py says how they are made).
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "client/odometry/tracker.h"

namespace maploc {
namespace {

constexpr double kTolerance = 1e-7;  // the vectors are of differences and series

using Json = nlohmann::json;

Rigid3 PoseOf(const Json& json) {
  const auto p = json.at("position").get<std::array<double, 3>>();
  const auto q = json.at("xyzw").get<std::array<double, 4>>();
  return {Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized(), {p[0], p[1], p[2]}};
}

UncertainPose UncertainPoseOf(const Json& json) {
  auto covariance = json.at("covariance").get<std::array<double, 36>>();
  return {PoseOf(json), Eigen::Map<PoseCovariance>(covariance.data())};  // symmetric
}

PoseSigmas SigmasOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>(),
          json.at(3).get<double>()};
}

TrackerOptions OptionsOf(const Json& json) {
  const Json& drift = json.at("drift");
  return {{SigmasOf(drift.at("at_rest")), SigmasOf(drift.at("per_meter")),
           SigmasOf(drift.at("per_radian"))},
          json.at("max_sigmas").get<double>(),
          json.at("agreeing_answers").get<int>(),
          json.at("smooth").get<bool>()};
}

std::string NameOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kTaken:
      return "TAKEN";
    case Verdict::kPositionContradicted:
      return "POSITION_CONTRADICTED";
    case Verdict::kRotationContradicted:
      return "ROTATION_CONTRADICTED";
    case Verdict::kUnconfirmed:
      return "UNCONFIRMED";
    case Verdict::kRelocated:
      return "RELOCATED";
  }
  return "";
}

void ExpectPose(const std::optional<UncertainPose>& found, const Json& json) {
  ASSERT_TRUE(found);
  const UncertainPose expected = UncertainPoseOf(json);
  EXPECT_LT(Difference(found->map_from_body, expected.map_from_body).norm(), kTolerance);
  EXPECT_LT((found->covariance - expected.covariance).cwiseAbs().maxCoeff(),
            kTolerance * expected.covariance.cwiseAbs().maxCoeff() + 1e-12);
}

void ExpectDecision(const Decision& found, const Json& step) {
  EXPECT_EQ(NameOf(found.verdict), step.at("verdict"));
  EXPECT_EQ(found.agreeing, step.at("agreeing"));
  ASSERT_EQ(found.gap.has_value(), !step.at("gap").is_null());
  if (!found.gap) return;
  const auto gap = step.at("gap").get<std::array<double, 4>>();
  EXPECT_NEAR(found.gap->distance_m, gap[0], kTolerance);
  EXPECT_NEAR(found.gap->angle_rad, gap[1], kTolerance);
  EXPECT_NEAR(found.gap->position_sigmas, gap[2], 1e-6 * (1.0 + gap[2]));
  EXPECT_NEAR(found.gap->rotation_sigmas, gap[3], 1e-6 * (1.0 + gap[3]));
}

void ExpectStep(Tracker& tracker, const Json& step) {
  const Rigid3 here = PoseOf(step.at("odom_from_base"));
  if (step.contains("answer")) {
    const Result<Decision> decision = tracker.Judge(here, UncertainPoseOf(step.at("answer")));
    ASSERT_TRUE(decision.ok()) << decision.status().ToString();
    ExpectDecision(*decision, step);
  } else {
    ASSERT_TRUE(tracker.Advance(here).ok());
  }
  EXPECT_EQ(tracker.held_in_a_row(), step.at("held_in_a_row"));
  ASSERT_EQ(tracker.MapFromOdom().has_value(), step.contains("map_from_odom"));
  if (!step.contains("map_from_odom")) return;
  ExpectPose(tracker.MapFromOdom(), step.at("map_from_odom"));
  ExpectPose(tracker.MapFromBase(PoseOf(step.at("later_odom_from_base"))),
             step.at("later_map_from_base"));
}

void ExpectDrive(const TrackerOptions& options, const Json& drive) {
  Result<Tracker> tracker = Tracker::Create(options);
  ASSERT_TRUE(tracker.ok()) << tracker.status().ToString();
  for (std::size_t i = 0; i < drive.at("steps").size(); ++i) {
    SCOPED_TRACE(drive.at("name").get<std::string>() + ", step " + std::to_string(i));
    ExpectStep(*tracker, drive.at("steps").at(i));
  }
}

Json Drives() {
  std::ifstream file(MAPLOC_SOURCE_DIR "/tests/unit/client/odometry/vectors.json");
  return Json::parse(file);
}

TEST(Vectors, AllDrives) {
  const Json drives = Drives();
  ASSERT_FALSE(drives.empty());
  for (const Json& drive : drives) ExpectDrive(OptionsOf(drive.at("options")), drive);
}

TEST(Vectors, TheFirstDriveHasTheDefaults) { ExpectDrive({}, Drives().at(0)); }

}  // namespace
}  // namespace maploc
