// Where the robot is, between answers and in spite of wrong ones: answers are held against odometry
// (README.md says the rule), and odometry carries the pose on where there is none.
#pragma once

#include <optional>
#include <vector>

#include "client/odometry/track.h"

namespace maploc {

struct TrackerOptions {
  OdometryDrift drift = {};
  // An answer further than this from what odometry makes of the answers before, in any direction
  // of its position or about any axis, is held back.
  double max_sigmas = 3.0;
  // So many held back answers that agree with each other are taken: the robot was carried away, or
  // it starts. At least 1; with 1 nothing is held back.
  int agreeing_answers = 3;
  // An answer is weighed with what is known before. Else the pose follows it wholly.
  bool smooth = true;
};

// Not thread-safe. The map must be metric.
class Tracker {
 public:
  // INVALID_ARGUMENT with the option's name.
  static Result<Tracker> Create(const TrackerOptions& options = {});

  // To be called for every localized answer, in the order of the images' stamps. `odom_from_base`
  // is the odometry at the image's stamp, `answer` has the same base as its body.
  // INVALID_ARGUMENT: one that is not finite, no rotation, no covariance; nothing has changed then.
  Result<Decision> Judge(const Rigid3& odom_from_base, const UncertainPose& answer);

  // To be called for images that were not localized, and where there are no images about once a
  // metre: so the way's length is known, also of a robot that drives round in circles.
  Status Advance(const Rigid3& odom_from_base);

  // The robot's pose, with the odometry of any moment since the last answer, for example the
  // newest. nullopt before the first pose.
  std::optional<UncertainPose> MapFromBase(const Rigid3& odom_from_base) const;
  // To be broadcast: constant until the next answer that is taken. nullopt before the first pose.
  std::optional<UncertainPose> MapFromOdom() const;

  // Answers that were held back since the last one that was taken. Images that were not localized
  // do not count.
  int held_in_a_row() const { return held_in_a_row_; }

 private:
  struct Candidate {
    Track track;
    int agreeing = 1;
  };

  explicit Tracker(const TrackerOptions& options) : options_(options) {}

  void AdvanceAll(const Rigid3& odom_from_base);
  // The candidate that the answer now belongs to.
  std::vector<Candidate>::iterator AddToCandidates(const Rigid3& odom_from_base,
                                                   const UncertainPose& answer, double max_sigmas);
  // How far a held back answer may be from a candidate to belong to it. `gap`: to the pose so far.
  double MostSigmasOfNewPlace(const std::optional<Gap>& gap) const;
  Verdict HoldBack(const std::optional<Gap>& gap);

  TrackerOptions options_;
  std::optional<Track> track_;
  std::vector<Candidate> candidates_;  // oldest first, at most `agreeing_answers`
  int held_in_a_row_ = 0;
};

}  // namespace maploc
