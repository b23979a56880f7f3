#include "client/robot/replay.h"

#include <gtest/gtest.h>

namespace maploc {
namespace {

ReplayEntry Answered(Outcome outcome, bool gravity_rejected) {
  ReplayEntry entry;
  entry.localization.outcome = outcome;
  entry.localization.evidence.gravity_rejected = gravity_rejected;
  return entry;
}

TEST(ReplayReportTest, CountsTheQueriesWhoseInputsWereNotBelieved) {
  ReplayReport report;
  report.entries = {Answered(Outcome::kLocalized, false), Answered(Outcome::kLocalized, true),
                    Answered(Outcome::kLocalized, true),
                    Answered(Outcome::kCalibrationInconsistent, false),
                    Answered(Outcome::kGravityInconsistent, false)};
  const InputFaults faults = report.CountInputFaults();
  EXPECT_EQ(faults.gravity_rejected, 2);
  EXPECT_EQ(faults.calibration_inconsistent, 1);
}

}  // namespace
}  // namespace maploc
