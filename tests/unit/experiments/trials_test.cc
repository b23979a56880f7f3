#include "tests/experiments/trials.h"

#include <gmock/gmock.h>

#include "tests/experiments/protocol.h"
#include "tests/experiments/refinement_comparison.h"

namespace maploc::experiments {
namespace {

Row WithoutTimes(Row row) {
  for (const char* key : {"median_ms", "p99_ms", "median_ransac_ms"}) row.erase(key);
  return row;
}

RunOptions Options(const std::vector<std::string>& methods, std::uint64_t seed = 1) {
  return {.methods = methods, .trials = 5, .seed = seed, .only = {}};
}

const std::vector<Setting> kSettings = {
    PaperSetting("test", {.inliers = 5, .outlier_rate = 0.5}),
    PaperSetting("test", {.inliers = 10, .outlier_rate = 0.8, .gravity_noise_deg = 1.0})};

TEST(RunSettings, SeesTheSameProblemsWhicheverMethodsAreAskedFor) {
  const Rows alone = RunSettings(kSettings, Options({"mixed-auto"})).value();
  const Rows among = RunSettings(kSettings, Options({"p3p", "mixed-auto", "2p-6dof"})).value();
  ASSERT_EQ(alone.size(), 2u);
  ASSERT_EQ(among.size(), 6u);
  EXPECT_EQ(WithoutTimes(alone[0]), WithoutTimes(among[1]));
  EXPECT_EQ(WithoutTimes(alone[1]), WithoutTimes(among[4]));
}

TEST(RunSettings, SeesTheSameProblemsWhicheverSettingsAreAskedFor) {
  RunOptions options = Options({"mixed-auto"});
  const Rows all = RunSettings(kSettings, options).value();
  options.only = {"outlier_rate=0.8", "inliers=10"};
  const Rows one = RunSettings(kSettings, options).value();
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(WithoutTimes(one[0]), WithoutTimes(all[1]));
}

TEST(RunSettings, OtherSeedsMakeOtherProblems) {
  const Rows first = RunSettings(kSettings, Options({"mixed-auto"}, 1)).value();
  const Rows second = RunSettings(kSettings, Options({"mixed-auto"}, 2)).value();
  EXPECT_NE(first[0]["median_rotation_error_deg"], second[0]["median_rotation_error_deg"]);
}

TEST(RunSettings, RefusesWhatLeavesNothing) {
  RunOptions options = Options({"mixed-auto"});
  options.only = {"inliers=7"};
  EXPECT_FALSE(RunSettings(kSettings, options).ok());
  options.only = {"inliers"};
  EXPECT_FALSE(RunSettings(kSettings, options).ok());
}

TEST(RunSettings, LeavesOutAMethodThatNeedsLinesWhereThereAreNone) {
  Setting setting = kSettings[0];
  setting.synthetic.line_inliers = setting.synthetic.line_outliers = 0;
  const Rows rows = RunSettings({setting}, Options({"1p1l-auto", "2p-auto"})).value();
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0]["method"], "2p-auto");
}

TEST(RunSettings, EveryMethodSolvesAnEasyProblem) {
  const Setting easy = PaperSetting("test", {.inliers = 30});
  const Rows rows = RunSettings({easy}, Options(AllMethodNames())).value();
  ASSERT_EQ(rows.size(), AllMethodNames().size());
  for (const Row& row : rows) EXPECT_EQ(row["success_rate"], 1.0) << row;
}

TEST(RunSettings, OursAndBaselinesUseExactlyTheProtocolsIterations) {
  const Rows rows =
      RunSettings(kSettings, Options({"1p1l-4dof", "2p-6dof", "mixed-auto", "p3p", "epnp", "2p1l"}))
          .value();
  ASSERT_EQ(rows.size(), 6 * kSettings.size());
  for (const Row& row : rows) EXPECT_EQ(row["mean_iterations"], 100.0) << row;
}

TEST(Quantile, IsANearestRank) {
  EXPECT_EQ(Quantile({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(Quantile({4, 1, 2, 3}, 0.5), 2);
  EXPECT_EQ(Quantile({4, 1, 2, 3}, 0.99), 4);
  EXPECT_EQ(Quantile({7}, 0.0), 7);
}

TEST(WithRefinementComparison, TellsAutoAsAMultipleOfTheOthers) {
  const auto row = [](const char* method, double error) {
    return Row{{"method", method}, {"inliers", 5}, {"median_rotation_error_deg", error}};
  };
  const Rows rows =
      WithRefinementComparison({row("2p-4dof", 2.0), row("2p-6dof", 4.0), row("2p-auto", 1.0)});
  EXPECT_EQ(rows[2]["rotation_to_better"], 0.5);
  EXPECT_EQ(rows[2]["rotation_to_worse"], 0.25);
  EXPECT_FALSE(rows[0].contains("rotation_to_better"));
}

TEST(PaperSetting, MakesOutliersThatSeeOtherLandmarksOfTheProblem) {
  const Setting setting = PaperSetting("test", {.inliers = 4, .outlier_rate = 0.8, .noise_px = 0});
  Random random = TrialRandom(1, "test", 0);
  const testing::SyntheticProblem made = testing::MakeSyntheticProblem(setting.synthetic, random);
  const auto& points = made.problem.points;
  ASSERT_EQ(points.size(), 20u);
  EXPECT_EQ(made.problem.lines.size(), 20u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<std::size_t> seen;  // the landmarks whose image this is
    for (std::size_t j = 0; j < points.size(); ++j) {
      const Eigen::Vector2d image =
          (made.camera_from_map * points[j].position_in_map).hnormalized();
      if ((image - points[i].normalized).norm() < 1e-9) seen.push_back(j);
    }
    ASSERT_EQ(seen.size(), 1u);
    EXPECT_EQ(seen[0] == i, made.point_is_inlier[i] != 0);
    EXPECT_EQ(made.point_is_inlier[seen[0]], made.point_is_inlier[i]);
  }
}

}  // namespace
}  // namespace maploc::experiments
