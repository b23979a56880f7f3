// The binary itself with a few trials: rows, exit codes, files. What the figures say is in
// tests/experiments/README.md.
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/support/files.h"
#include "tests/support/run_binary.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

Output RunExperiments(const std::string& arguments) {
  return RunBinary("maploc-experiments " + arguments);
}

nlohmann::json Rows(const std::string& arguments) {
  const Output run = RunExperiments(arguments + " --json");
  EXPECT_EQ(run.exit_code, 0) << run.error;
  nlohmann::json rows = nlohmann::json::parse(run.out, nullptr, false);
  EXPECT_TRUE(rows.is_array()) << run.out;
  return rows;
}

void ExpectKeys(const nlohmann::json& row, const std::set<std::string>& keys) {
  for (const std::string& key : keys) EXPECT_TRUE(row.contains(key)) << key << " of " << row;
}

TEST(Experiments, RobustnessHasTheContractsGridAndKeys) {
  const nlohmann::json rows = Rows("robustness --trials 2 --methods mixed-auto,p3p");
  EXPECT_EQ(rows.size(), 2u * 4 * 9 * 2);
  for (const nlohmann::json& row : rows) {
    ExpectKeys(row, {"experiment", "method", "inliers", "outlier_rate", "noise_px",
                     "gravity_noise_deg", "trials", "success_rate", "median_ms", "p99_ms"});
    if (row["method"] == "mixed-auto" && row["inliers"] == 10 && row["outlier_rate"] == 0.0) {
      EXPECT_EQ(row["success_rate"], 1.0) << row;
    }
  }
}

TEST(Experiments, RobustnessFallsWithOutliersForThreePointsAlone) {
  const nlohmann::json rows =
      Rows("robustness --trials 20 --methods p3p --only inliers=10 --only gravity_noise_deg=0");
  ASSERT_EQ(rows.size(), 9u);
  EXPECT_EQ(rows.front()["success_rate"], 1.0);
  EXPECT_LT(rows.back()["success_rate"], 1.0);
}

TEST(Experiments, AccuracyComparesAutoWithTheOthersAndGrowsWithNoise) {
  const nlohmann::json rows = Rows(
      "accuracy --trials 20 --methods 2p-4dof,2p-6dof,2p-auto --only inliers=10 "
      "--only gravity_noise_deg=1");
  ASSERT_EQ(rows.size(), 7u * 3);
  ExpectKeys(rows[2 * 3 + 2], {"rotation_to_better", "translation_to_worse"});
  EXPECT_LT(rows[3 + 2]["median_translation_error_percent"],
            rows[6 * 3 + 2]["median_translation_error_percent"]);
}

TEST(Experiments, SensitivityReaches25Degrees) {
  const nlohmann::json rows = Rows("sensitivity --trials 2 --methods mixed-4dof");
  EXPECT_EQ(rows.front()["gravity_noise_deg"], 0.0);
  EXPECT_EQ(rows.front()["success_rate"], 1.0);
  EXPECT_EQ(rows.back()["gravity_noise_deg"], 25.0);
}

TEST(Experiments, TimingHasTheContractsGridAndKeys) {
  const nlohmann::json rows = Rows("timing --trials 1 --methods 2p-auto");
  EXPECT_EQ(rows.size(), 3u * 5 + 3);
  for (const nlohmann::json& row : rows) {
    ExpectKeys(row, {"points", "lines", "inlier_ratio", "median_ms", "p99_ms", "success_rate"});
    EXPECT_FALSE(row.contains("inliers"));
  }
}

TEST(Experiments, FalseAcceptsTellShiftedRepeatsApart) {
  const nlohmann::json rows = Rows("false-accepts --trials 5");
  std::set<std::string> kinds;
  for (const nlohmann::json& row : rows) {
    ExpectKeys(row, {"matches", "queries", "localized", "largest_confidence"});
    const std::string kind = row["matches"];
    kinds.insert(kind);
    if (kind.starts_with("one shift")) {
      EXPECT_GT(row["localized"], 0) << "a wrong pose explains these: " << row;
    } else {
      EXPECT_EQ(row["localized"], 0) << row;
    }
  }
  EXPECT_THAT(kinds, UnorderedElementsAre("random points", "random points and lines",
                                          "repeats, points", "repeats, points and lines",
                                          "moved signs", "one shift for 20%", "one shift for 50%"));
}

TEST(Experiments, ReliabilityTellsAShareABin) {
  const nlohmann::json rows = Rows("reliability --trials 100");
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows.back()["confidence_to"], 1.0);
  ExpectKeys(rows.back(), {"confidence_from", "answers", "success_rate", "mean_confidence"});
}

TEST(Experiments, WritesCsvAndCharts) {
  const TemporaryFolder folder;
  const Output run = RunExperiments("sensitivity --trials 1 --methods 2p-auto --csv " +
                                    folder.File("rows.csv") + " --plot " + folder.File("charts"));
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.out, HasSubstr("2p-auto"));  // a table, without --json
  EXPECT_THAT(folder.Read("rows.csv"), StartsWith("experiment,method,inliers,"));
  for (const std::string name : {"success", "rotation", "translation"}) {
    EXPECT_THAT(folder.Read("charts/sensitivity_" + name + ".svg"), StartsWith("<svg")) << name;
  }
}

TEST(Experiments, AddsTheRowsOfAnEarlierRun) {
  const TemporaryFolder folder;
  const std::string file = folder.File("earlier.json");
  const std::string only = "robustness --trials 1 --only inliers=10 --only outlier_rate=0.8 ";
  WriteFile(file, RunExperiments(only + "--methods p3p --json").out);
  const nlohmann::json rows = Rows(only + "--methods 2p-auto --add " + file);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0]["method"], "2p-auto");
  EXPECT_EQ(rows[3]["method"], "p3p");
  EXPECT_EQ(RunExperiments("timing --trials 1 --add " + file).exit_code, 1);
}

TEST(Experiments, WrongUsageIsTwo) {
  for (const std::string wrong : {"", "nothing", "robustness --methods p3p,p4p",
                                  "robustness --trials many", "robustness --trails 1"}) {
    const Output refused = RunExperiments(wrong);
    EXPECT_EQ(refused.exit_code, 2) << wrong << ": " << refused.error;
  }
}

TEST(Experiments, WhatCannotBeDoneIsOneAndALine) {
  for (const std::string arguments :
       {"robustness --trials 0", "robustness --trials 1 --csv /nowhere/rows.csv",
        "robustness --trials 1 --plot /proc/charts", "robustness --only inliers=11",
        "false-accepts --trials 1 --methods epnp"}) {
    SCOPED_TRACE(arguments);
    ExpectFailed(RunExperiments(arguments), "maploc-experiments: ");
  }
}

// On a full disk.
TEST(Experiments, ATableThatDoesNotArriveIsAFailure) {
  for (const std::string arguments :
       {"--help", "accuracy --help", "selection --help", "lies --help",
        "robustness --trials 1 --methods p3p --only inliers=10 --json",
        "robustness --trials 1 --methods p3p --only inliers=10"}) {
    SCOPED_TRACE(arguments);
    const TemporaryFolder folder;
    const std::string command = std::string(MAPLOC_BIN_DIR) + "/maploc-experiments " + arguments +
                                " >/dev/full 2>" + folder.File("error");
    const int status = std::system(command.c_str());
    EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 1);
    EXPECT_THAT(folder.Read("error"), HasSubstr("standard output cannot be written: "));
  }
}

TEST(Experiments, HelpHasAnExample) {
  for (const std::string command :
       {"accuracy", "sensitivity", "robustness", "timing", "false-accepts", "reliability"}) {
    const Output run = RunExperiments(command + " --help");
    EXPECT_EQ(run.exit_code, 0) << command << ": " << run.error;
    EXPECT_THAT(run.out, HasSubstr("Example:\n  maploc-experiments " + command));
  }
}

}  // namespace
}  // namespace maploc::testing
