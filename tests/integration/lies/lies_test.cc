// Never sure and wrong: no answer may be LOCALIZED and wrong because an input lied, and honest
// queries must not pay for it.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/experiments/lies/run_lies.h"
#include "tests/support/shared_data.h"

namespace maploc::lies {
namespace {

struct Sum {
  int queries = 0;
  int localized = 0;
  int off = 0;
  int wrong = 0;
};

class LiesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.data_folder = testing::SharedDataFolder().string();
    if (!std::filesystem::is_directory(options_.data_folder)) {
      GTEST_SKIP() << "no real data: " << options_.data_folder
                   << " does not exist; set MAPLOC_SHARED_DATA to the folder that holds it";
    }
  }

  experiments::Rows Tell(const std::string& set, std::vector<std::string> families) {
    options_.sets = {set};
    options_.families = std::move(families);
    const Result<experiments::Rows> rows = RunLies(options_);
    EXPECT_TRUE(rows.ok()) << rows.status().ToString();
    return rows.ok() ? *rows : experiments::Rows();
  }

  static Sum SumOf(const experiments::Rows& rows, const std::string& family) {
    Sum sum;
    for (const experiments::Row& row : rows) {
      if (row["family"] != family) continue;
      sum.queries += row["queries"].get<int>();
      sum.localized += row["localized"].get<int>();
      sum.off += row["off"].get<int>();
      sum.wrong += row["wrong"].get<int>();
      if (row["wrong"] != 0) ADD_FAILURE() << row.dump();
    }
    return sum;
  }

  LieOptions options_;
};

TEST_F(LiesTest, AWrongGravityMisleadsNobodyInARoom) {
  const experiments::Rows rows = Tell("euroc_v101", {"honest", "frame", "mirror"});
  ASSERT_FALSE(rows.empty());
  EXPECT_GE(rows.front()["right"], 70) << rows.front().dump();
  EXPECT_GE(rows.front()["median_sigmas"], 0.7);
  EXPECT_LE(rows.front()["median_sigmas"], 2.0);
  EXPECT_LE(rows.front()["p95_sigmas"], 3.5);
  EXPECT_LE(rows.front()["worst_sigmas"], 8.0);
  const Sum frame = SumOf(rows, "frame");
  EXPECT_EQ(frame.queries, 71 * 64);
  EXPECT_LE(frame.off, frame.localized / 500);
  EXPECT_GE(frame.localized, 0.95 * 64 * rows[1]["localized"].get<int>());
  EXPECT_EQ(SumOf(rows, "mirror").localized, 0);
}

TEST_F(LiesTest, NorBeforeAChurchAndNoMirroredPhotoIsBelieved) {
  const experiments::Rows rows = Tell("herzjesu", {"honest", "mirror", "calibration"});
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows.front()["right"], 8) << rows.front().dump();
  EXPECT_EQ(SumOf(rows, "mirror").localized, 0);
  EXPECT_EQ(SumOf(rows, "calibration").wrong, 0);
}

TEST_F(LiesTest, AMirroredPhotoOfAMirrorSymmetricFrontIsNotBelieved) {
  const experiments::Rows rows = Tell("reichstag", {"honest", "mirror"});
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows.front()["right"], 16) << rows.front().dump();
  EXPECT_EQ(SumOf(rows, "mirror").localized, 0);
}

TEST_F(LiesTest, AtNightLinesNeverMakeItWorse) {
  options_.draws = 12;
  const experiments::Rows rows = Tell("sacre_coeur", {"few"});
  ASSERT_EQ(rows.size(), 12u);
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    const experiments::Row& points = rows[i];
    const experiments::Row& with_lines = rows[i + 1];
    EXPECT_GE(with_lines["right"], points["right"]) << with_lines.dump();
    EXPECT_EQ(with_lines["wrong"], 0);
  }
}

}  // namespace
}  // namespace maploc::lies
