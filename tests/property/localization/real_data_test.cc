// The pipeline on the real sets, offline. Prints errors and stage times; skipped where the data is
// not.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>

#include "server/pipeline/localizer.h"
#include "tests/property/localization/recorded_set.h"
#include "tests/support/seed.h"
#include "tests/support/shared_data.h"

namespace maploc {
namespace {

using testing::RecordedQuery;
using testing::RecordedSet;
using testing::SetDescription;

constexpr double kDegree = std::numbers::pi / 180.0;

struct Report {
  int localized = 0;
  int near = 0;   // within 0.25 m and 5 degrees
  int wrong = 0;  // LOCALIZED, and more than 1 m or 10 degrees off
  std::vector<double> translation_m;
  std::vector<double> rotation_rad;
  std::vector<StageTimes> times;
};

double Quantile(std::vector<double> values, double q) {
  if (values.empty()) return 1e9;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(q * values.size()))];
}

void Add(const RecordedQuery& recorded, const Localization& answer, Report& report) {
  report.times.push_back(answer.times);
  const Evidence& e = answer.evidence;
  std::printf("%-38s %-20s seg %2d  %4d/%4d it %5d conf %.4f grav %.2f deg", recorded.name.c_str(),
              std::string(OutcomeName(answer.outcome)).c_str(), answer.segment, e.points.inliers,
              e.points.matches, e.iterations, e.confidence, e.gravity_disagreement_rad / kDegree);
  if (answer.outcome == Outcome::kLocalized) {
    const Rigid3 truth = recorded.camera_from_map.Inverse();
    const double t = (answer.map_from_body->translation - truth.translation).norm();
    const double r = truth.rotation.angularDistance(answer.map_from_body->rotation);
    ++report.localized;
    report.near += t <= 0.25 && r <= 5 * kDegree;
    report.wrong += t > 1.0 || r > 10 * kDegree;
    report.translation_m.push_back(t);
    report.rotation_rad.push_back(r);
    std::printf("  %.4f m %.3f deg", t, r / kDegree);
  }
  std::printf("\n");
}

Report Replay(const RecordedSet& set) {
  Report report;
  for (const RecordedQuery& recorded : set.queries) {
    const auto answer = Localize(recorded.query, *set.map, {}, kNoDeadline, nullptr);
    EXPECT_TRUE(answer.ok()) << answer.status().ToString();
    if (answer.ok()) Add(recorded, *answer, report);
  }
  return report;
}

void PrintStage(const char* name, const Report& report, double StageTimes::*stage) {
  std::vector<double> values;
  for (const StageTimes& times : report.times) values.push_back(times.*stage);
  std::printf("%-12s p50 %7.2f ms  p99 %7.2f ms\n", name, Quantile(values, 0.5),
              Quantile(values, 0.99));
}

void Print(const Report& report) {
  std::printf("localized %d of %zu, near %d, wrong %d; median %.4f m %.3f deg, worst %.3f m %.3f\n",
              report.localized, report.times.size(), report.near, report.wrong,
              Quantile(report.translation_m, 0.5), Quantile(report.rotation_rad, 0.5) / kDegree,
              Quantile(report.translation_m, 1.0), Quantile(report.rotation_rad, 1.0) / kDegree);
  PrintStage("retrieval", report, &StageTimes::retrieval_ms);
  PrintStage("matching", report, &StageTimes::matching_ms);
  PrintStage("ransac", report, &StageTimes::ransac_ms);
  PrintStage("refinement", report, &StageTimes::refinement_ms);
  PrintStage("total", report, &StageTimes::total_ms);
}

class RealDataTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(testing::SharedDataFolder())) {
      GTEST_SKIP() << "no real data: " << testing::SharedDataFolder().string()
                   << " does not exist; set MAPLOC_SHARED_DATA to the folder that holds it";
    }
  }

  Report RunSet(const SetDescription& description) {
    Random random = testing::TestRandom();
    const auto set = testing::LoadRecordedSet(description, random);
    EXPECT_TRUE(set.ok()) << set.status().ToString();
    if (!set.ok()) return {};
    const Report report = Replay(*set);
    Print(report);
    return report;
  }
};

TEST_F(RealDataTest, DroneInARoomWithItsOwnGravity) {
  const std::string folder = (testing::SharedDataFolder() / "euroc_v101").string();
  const Report report = RunSet({
      .folder = folder,
      .sessions = {"session_1", "session_2", "session_3", "session_4"},
      .gravity_in_source = {0, 0, -1},
      .gravity = {.csv = folder + "/gravity.csv", .sent_sigma_rad = 1.0 * kDegree},
  });
  ASSERT_EQ(report.times.size(), 71u);
  EXPECT_GE(report.near, 68);
  EXPECT_EQ(report.wrong, 0);
  EXPECT_LE(Quantile(report.translation_m, 0.5), 0.03);
}

TEST_F(RealDataTest, ChurchFrontWithNoisyGravity) {
  const Report report = RunSet({
      .folder = (testing::SharedDataFolder() / "herzjesu").string(),
      .sessions = {"query"},
      .gravity_in_source = {0, 0, 1},
      .gravity = {.csv = "", .noise_sigma_rad = 0.5 * kDegree, .sent_sigma_rad = 0.5 * kDegree},
  });
  ASSERT_EQ(report.times.size(), 8u);
  EXPECT_EQ(report.localized, 8);
  EXPECT_EQ(report.wrong, 0);
  EXPECT_LE(Quantile(report.translation_m, 0.5), 0.01);
  EXPECT_LE(Quantile(report.rotation_rad, 0.5), 0.05 * kDegree);
  EXPECT_LE(Quantile(report.translation_m, 1.0), 0.05);
  EXPECT_LE(Quantile(report.rotation_rad, 1.0), 0.2 * kDegree);
}

}  // namespace
}  // namespace maploc
