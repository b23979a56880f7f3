// A robot's drive through hills with its odometry and the answers to its images. Nothing here knows
// the tracker's laws: odometry errs by a wrong scale, a biased heading, slips and noise with heavy
// tails, in a tenth of the drives twice as much as its drift states; right answers err with heavy
// tails around their stated covariance and with a part that belongs to the place.
#pragma once

#include <optional>
#include <vector>

#include "client/odometry/uncertain_pose.h"
#include "mapstore/base/random.h"

namespace maploc::testing {

enum class AnswerKind {
  kNone,     // the image was not localized
  kRight,    //
  kWrong,    // alone: 0.5 to 5 m off
  kAliased,  // one of a run with the same offset: places that look alike
};

struct Moment {
  Rigid3 map_from_base;  // the truth
  Rigid3 odom_from_base;
  AnswerKind kind = AnswerKind::kNone;
  UncertainPose answer;        // unless kNone
  bool carried_away = false;   // right before this moment
  int aliased_run_length = 0;  // of the run that this answer belongs to
};

struct Drive {
  std::vector<Moment> moments;  // 10 a second
  bool planar_odometry = false;
  bool beyond_stated_drift = false;
};

struct DriveOptions {
  int moments = 600;
  double wrong_share = 0.05;
  bool carried_away = true;              // once in every second drive
  bool aliased = true;                   // a run of 1 to 8 in every second drive
  std::optional<double> answer_sigma_m;  // else 0.03 to 0.15, by the drive
  double place_share = 0.3;              // of the answers' standard deviation, common to a place
};

Drive SimulateDrive(const DriveOptions& options, Random random);

}  // namespace maploc::testing
