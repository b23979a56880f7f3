// What the gate promises, over many simulated drives.
#include <cstdlib>
#include <iostream>
#include <map>

#include <gtest/gtest.h>

#include "client/odometry/tracker.h"
#include "tests/property/odometry/simulated_drive.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using testing::AnswerKind;
using testing::Drive;
using testing::DriveOptions;
using testing::Moment;
using testing::SimulateDrive;

// MAPLOC_DRIVES in the environment: the long form.
int DriveCount() {
  const char* count = std::getenv("MAPLOC_DRIVES");
  return count != nullptr ? std::atoi(count) : 200;
}

double Distance(const Rigid3& a, const Rigid3& b) { return (a.translation - b.translation).norm(); }

struct Tally {
  long right = 0;
  long right_held = 0;
  long wrong = 0;
  long wrong_taken = 0;               // because odometry does not contradict them
  long contradicted_taken = 0;        // of these, by an independent reading: must not be
  double largest_wrong_step_m = 0.0;  // of the pose, by one of them
  long relocated_by_wrong = 0;        // the last of those that agreed was wrong
  long relocated_uncarried = 0;       // all of them right, in the midst of a drive
  double largest_uncarried_step_m = 0.0;
  double answers_squared = 0.0;
  double output_squared = 0.0;
  long compared = 0;
  double largest_error_m = 0.0;  // of the pose, while nothing misled it
  long carried = 0;
  long lost_at_end = 0;
  std::map<int, long> recoveries;           // by right answers since the robot was carried away
  std::map<int, std::array<long, 2>> runs;  // of wrong answers, by length: all, followed
};

// By the answer's own direction alone, from what the tracker tells in public: an independent
// reading of "contradicted by 3 sigma".
bool Contradicted(const UncertainPose& answer, const UncertainPose& expected) {
  const Eigen::Vector3d gap = answer.map_from_body.translation - expected.map_from_body.translation;
  const Eigen::Matrix3d sum =
      (answer.covariance + expected.covariance + AtRestCovariance(OdometryDrift()))
          .topLeftCorner<3, 3>();
  const Eigen::Vector3d way = gap.normalized();
  return gap.norm() > 3.0 * std::sqrt(way.dot(sum * way));
}

class Run {
 public:
  Run(const TrackerOptions& options, Tally& tally)
      : tracker_(*Tracker::Create(options)), tally_(tally) {}

  void See(const Drive& drive) {
    for (const Moment& moment : drive.moments) {
      if (moment.carried_away) StartRecovery();
      if (moment.kind == AnswerKind::kNone) {
        ASSERT_TRUE(tracker_.Advance(moment.odom_from_base).ok());
      } else {
        SeeAnswer(moment);
      }
      Compare(moment);
    }
    tally_.lost_at_end += !tracker_.MapFromOdom() || ErrorAt(drive.moments.back()) > 0.5;
  }

 private:
  void StartRecovery() {
    ++tally_.carried;
    misled_ = true;
    right_since_carried_ = 0;
  }

  void SeeAnswer(const Moment& moment) {
    const auto before = tracker_.MapFromBase(moment.odom_from_base);
    const Result<Decision> decision = tracker_.Judge(moment.odom_from_base, moment.answer);
    ASSERT_TRUE(decision.ok());
    if (moment.kind == AnswerKind::kRight) CountRight(moment, *decision, before);
    if (moment.kind == AnswerKind::kWrong) CountWrong(moment, *decision, before);
    if (moment.kind == AnswerKind::kAliased) CountAliased(moment, *decision);
  }

  double StepFrom(const UncertainPose& before, const Moment& moment) const {
    return Distance(tracker_.MapFromBase(moment.odom_from_base)->map_from_body,
                    before.map_from_body);
  }

  void CountRight(const Moment& moment, const Decision& decision,
                  const std::optional<UncertainPose>& before) {
    ++tally_.right;
    tally_.right_held += !decision.taken();
    if (right_since_carried_) ++*right_since_carried_;
    if (!decision.taken()) return;
    if (misled_ || !before) {
      Recover(moment);
    } else if (decision.verdict == Verdict::kRelocated) {
      ++tally_.relocated_uncarried;
      tally_.largest_uncarried_step_m =
          std::max(tally_.largest_uncarried_step_m, StepFrom(*before, moment));
    }
  }

  void Recover(const Moment& moment) {
    misled_ = ErrorAt(moment) > 0.5;
    if (misled_ || !right_since_carried_) return;
    ++tally_.recoveries[*right_since_carried_];
    right_since_carried_.reset();
  }

  void CountWrong(const Moment& moment, const Decision& decision,
                  const std::optional<UncertainPose>& before) {
    ++tally_.wrong;
    tally_.relocated_by_wrong += decision.verdict == Verdict::kRelocated && !misled_;
    if (decision.verdict != Verdict::kTaken) return;
    ++tally_.wrong_taken;
    tally_.contradicted_taken += Contradicted(moment.answer, *before);
    tally_.largest_wrong_step_m = std::max(tally_.largest_wrong_step_m, StepFrom(*before, moment));
  }

  double ErrorAt(const Moment& moment) const {
    return Distance(tracker_.MapFromBase(moment.odom_from_base)->map_from_body,
                    moment.map_from_base);
  }

  void CountAliased(const Moment& moment, const Decision& decision) {
    if (run_length_ != moment.aliased_run_length) {  // one run a drive
      run_length_ = moment.aliased_run_length;
      ++tally_.runs[run_length_][0];
    }
    if (decision.verdict != Verdict::kRelocated) return;
    ++tally_.runs[run_length_][1];
    misled_ = true;
  }

  void Compare(const Moment& moment) {
    if (misled_ || !tracker_.MapFromOdom()) return;
    const double error = ErrorAt(moment);
    tally_.largest_error_m = std::max(tally_.largest_error_m, error);
    if (moment.kind != AnswerKind::kRight) return;
    const double answers = Distance(moment.answer.map_from_body, moment.map_from_base);
    tally_.output_squared += error * error;
    tally_.answers_squared += answers * answers;
    ++tally_.compared;
  }

  Tracker tracker_;
  Tally& tally_;
  bool misled_ = false;  // carried away, or followed a run, and not back yet
  std::optional<int> right_since_carried_;
  int run_length_ = 0;
};

Tally DriveAll(const DriveOptions& options, int count, const TrackerOptions& tracker = {}) {
  Tally tally;
  const Random random = testing::TestRandom();
  for (int i = 0; i < count; ++i) Run(tracker, tally).See(SimulateDrive(options, random.Fork(i)));
  return tally;
}

double ErrorRatio(const Tally& tally) {
  return std::sqrt(tally.output_squared / tally.answers_squared);
}

long RecoveredWithin(const Tally& tally, int answers) {
  long drives = 0;
  for (const auto& [count, recovered] : tally.recoveries)
    drives += count <= answers ? recovered : 0;
  return drives;
}

void Print(const Tally& tally) {
  std::cout << "right answers " << tally.right << ", held back " << tally.right_held
            << "; wrong ones " << tally.wrong << ", taken " << tally.wrong_taken
            << " (contradicted " << tally.contradicted_taken << "), largest step by one "
            << tally.largest_wrong_step_m << " m\n"
            << "relocated by answers of which a wrong one was the last " << tally.relocated_by_wrong
            << ", by right ones though not carried away " << tally.relocated_uncarried << " (by "
            << tally.largest_uncarried_step_m << " m at most); lost at the end "
            << tally.lost_at_end << "\n"
            << "error over single answers' " << ErrorRatio(tally) << " (single "
            << std::sqrt(tally.answers_squared / static_cast<double>(tally.compared))
            << " m), largest " << tally.largest_error_m << " m\n"
            << "carried away " << tally.carried << "\n";
  for (const auto& [answers, drives] : tally.recoveries) {
    std::cout << "  found after " << answers << " right answers: " << drives << "\n";
  }
  for (const auto& [length, counts] : tally.runs) {
    std::cout << "runs of " << length << " consistent wrong answers: " << counts[0] << ", followed "
              << counts[1] << "\n";
  }
}

void ExpectNoContradictedJump(const Tally& tally) {
  ASSERT_GT(tally.wrong, 0);
  EXPECT_EQ(tally.contradicted_taken, 0);
  EXPECT_LT(static_cast<double>(tally.relocated_by_wrong), 1e-4 * static_cast<double>(tally.wrong));
}

TEST(Drives, NoContradictedJumpPassesAndACarriedRobotIsFound) {
  const Tally tally = DriveAll({}, DriveCount());
  Print(tally);
  ExpectNoContradictedJump(tally);
  EXPECT_LE(ErrorRatio(tally), 0.5);
  EXPECT_LT(tally.largest_wrong_step_m, 0.25);
  EXPECT_LT(tally.largest_error_m, 1.0);
  EXPECT_EQ(tally.lost_at_end, 0);
  ASSERT_GT(tally.carried, 0);
  EXPECT_GE(static_cast<double>(RecoveredWithin(tally, 3)),
            0.95 * static_cast<double>(tally.carried));
  EXPECT_EQ(RecoveredWithin(tally, 6), tally.carried);
  EXPECT_LE(static_cast<double>(tally.runs.at(2)[1]),
            0.01 * static_cast<double>(tally.runs.at(2)[0]));
}

TEST(Drives, NoContradictedJumpPassesWithoutSmoothing) {
  const Tally tally = DriveAll({}, DriveCount() / 10, {.smooth = false});
  Print(tally);
  ExpectNoContradictedJump(tally);
}

// As good as half is possible while the answers err more than odometry over the next metre.
TEST(Drives, TheErrorHalvesWhateverTheAnswersErr) {
  for (const double sigma_m : {0.03, 0.05, 0.1, 0.2}) {
    DriveOptions options;
    options.answer_sigma_m = sigma_m;
    const Tally tally = DriveAll(options, DriveCount() / 10);
    EXPECT_LE(ErrorRatio(tally), 0.5) << sigma_m;
  }
}

}  // namespace
}  // namespace maploc
