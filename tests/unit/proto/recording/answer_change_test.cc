#include "proto/recording/answer_change.h"

#include <sstream>

#include <gmock/gmock.h>

#include "proto/recording/change_report.h"
#include "tests/unit/proto/recording/recorded_bytes.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

// At `x`, with so large a sigma of each axis.
Localization At(double x, double sigma = 0.1) {
  Localization answer = LocalizedAnswer();
  answer.map_from_body->translation.x() = x;
  answer.covariance = sigma * sigma * PoseCovariance::Identity();
  return answer;
}

Localization Lost(Outcome outcome = Outcome::kNoConsensus) {
  Localization answer;
  answer.outcome = outcome;
  return answer;
}

Change ChangeBetween(const Result<Localization>& before, const Result<Localization>& after) {
  return CompareAnswers(before, after).change;
}

TEST(AnswerChange, APoseIsBetterThanNone) {
  EXPECT_EQ(ChangeBetween(At(0), Lost()), Change::kWorse);
  EXPECT_EQ(ChangeBetween(Lost(), At(0)), Change::kBetter);
  EXPECT_EQ(ChangeBetween(At(0), Internal("no")), Change::kWorse);
  EXPECT_EQ(ChangeBetween(Lost(), Lost(Outcome::kLowConfidence)), Change::kSame);
}

TEST(AnswerChange, SigmasDecideWhatMovedAndWhoIsSurer) {
  EXPECT_EQ(ChangeBetween(At(0), At(0.5)), Change::kSame);  // of 0.73
  EXPECT_EQ(ChangeBetween(At(0), At(0.8)), Change::kMoved);
  EXPECT_EQ(ChangeBetween(At(0, 0.1), At(0, 0.104)), Change::kSame);
  EXPECT_EQ(ChangeBetween(At(0, 0.1), At(0, 0.106)), Change::kWorse);
  EXPECT_EQ(ChangeBetween(At(0, 0.106), At(0, 0.1)), Change::kBetter);
  Localization turned = At(0);
  turned.map_from_body->rotation = Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(ChangeBetween(At(0), turned), Change::kMoved);
  EXPECT_NEAR(*CompareAnswers(At(0), At(0.5)).translation, 0.5, 1e-12);
  EXPECT_NEAR(*CompareAnswers(At(0), turned).rotation_rad, 0.8, 1e-12);
}

TEST(AnswerChange, ChanceIsThatOfFairCoins) {
  EXPECT_NEAR(ChanceOf(0, 6), 2.0 / 64, 1e-12);
  EXPECT_NEAR(ChanceOf(6, 0), 2.0 / 64, 1e-12);
  EXPECT_NEAR(ChanceOf(1, 7), 2.0 * 9 / 256, 1e-12);
  EXPECT_EQ(ChanceOf(0, 0), 1.0);
  EXPECT_EQ(ChanceOf(4, 4), 1.0);
  EXPECT_LT(ChanceOf(400, 600), 1e-8);
}

TEST(ChangeReport, AVerdictNeedsMoreThanChance) {
  const RecordedQuery recorded = RecordedQueryFromBytes(ValidRecord().SerializeAsString()).value();
  ChangeReport report("version 1", "version 2");
  for (int i = 0; i < 5; ++i) report.Add(recorded, At(0), Lost());
  EXPECT_EQ(report.Json()["verdict"], "no difference");  // 1 of 16
  report.Add(recorded, At(0), Lost());
  report.Add(recorded, At(0), At(9));
  report.Add(recorded, At(0), At(0, 0.102));
  const auto json = report.Json();
  EXPECT_EQ(json["verdict"], "worse");
  EXPECT_EQ(json["worse"], 6);
  EXPECT_EQ(json["moved"], 1);
  EXPECT_EQ(json["same"], 1);
  EXPECT_EQ(json["localized_before"], 8);
  EXPECT_EQ(json["localized_after"], 2);
  EXPECT_EQ(json["per_query"].size(), 8u);
  EXPECT_NEAR(json["median_sigma_ratio"], 1.01, 1e-9);  // of 1 and 1.02
  std::ostringstream text;
  report.Print(text);
  EXPECT_THAT(text.str(), HasSubstr("8 queries: 0 better, 6 worse, 1 moved, 1 the same"));
  EXPECT_THAT(text.str(), HasSubstr("version 2 against version 1: worse"));
}

}  // namespace
}  // namespace maploc::testing
