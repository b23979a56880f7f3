#include "client/odometry/tracker.h"

#include <algorithm>
#include <cmath>

namespace maploc {
namespace {

// Answers of a new place may be a little further apart: here a right one that is left out costs the
// robot's time. But they must agree three times as well as with the pose so far, else a few with
// large errors on the same side would move it.
constexpr double kNewPlaceFactor = 1.5;
constexpr double kTimesBetter = 3.0;

double Worst(const Gap& gap) { return std::max(gap.position_sigmas, gap.rotation_sigmas); }

}  // namespace

Result<Tracker> Tracker::Create(const TrackerOptions& options) {
  MAPLOC_RETURN_IF_ERROR(CheckDrift(options.drift));
  if (!std::isfinite(options.max_sigmas) || options.max_sigmas <= 0.0) {
    return InvalidArgument("max_sigmas", "must be finite and positive", "OUT_OF_RANGE");
  }
  if (options.agreeing_answers < 1 || options.agreeing_answers > 100) {
    return InvalidArgument("agreeing_answers", "must be in 1 to 100", "OUT_OF_RANGE");
  }
  return Tracker(options);
}

Result<Decision> Tracker::Judge(const Rigid3& odom_from_base, const UncertainPose& answer) {
  // Everything is checked before anything changes.
  MAPLOC_RETURN_IF_ERROR(CheckPose("odom_from_base", odom_from_base));
  MAPLOC_RETURN_IF_ERROR(CheckPose("answer.map_from_body", answer.map_from_body));
  MAPLOC_RETURN_IF_ERROR(CheckCovariance("answer.covariance", answer.covariance));
  AdvanceAll(odom_from_base);
  Decision decision;
  if (track_) decision.gap = track_->GapTo(odom_from_base, answer);
  if (decision.gap && Worst(*decision.gap) <= options_.max_sigmas) {
    track_->Take(odom_from_base, answer, options_.smooth);
    decision.verdict = Verdict::kTaken;
    // Answer and odometry agree on this place, so the answers of other places were wrong.
    candidates_.clear();
    held_in_a_row_ = 0;
    return decision;
  }
  const auto candidate =
      AddToCandidates(odom_from_base, answer, MostSigmasOfNewPlace(decision.gap));
  decision.agreeing = candidate->agreeing;
  if (candidate->agreeing < options_.agreeing_answers) {
    decision.verdict = HoldBack(decision.gap);
    return decision;
  }
  decision.verdict = Verdict::kRelocated;
  track_ = candidate->track;
  candidates_.clear();
  held_in_a_row_ = 0;
  return decision;
}

Status Tracker::Advance(const Rigid3& odom_from_base) {
  MAPLOC_RETURN_IF_ERROR(CheckPose("odom_from_base", odom_from_base));
  AdvanceAll(odom_from_base);
  return Status::Ok();
}

std::optional<UncertainPose> Tracker::MapFromBase(const Rigid3& odom_from_base) const {
  if (!track_) return std::nullopt;
  return track_->MapFromBase(odom_from_base);
}

std::optional<UncertainPose> Tracker::MapFromOdom() const {
  if (!track_) return std::nullopt;
  return track_->MapFromOdom();
}

double Tracker::MostSigmasOfNewPlace(const std::optional<Gap>& gap) const {
  if (!gap) return options_.max_sigmas;
  return std::min(kNewPlaceFactor * options_.max_sigmas, Worst(*gap) / kTimesBetter);
}

void Tracker::AdvanceAll(const Rigid3& odom_from_base) {
  if (track_) track_->Advance(odom_from_base);
  for (Candidate& candidate : candidates_) candidate.track.Advance(odom_from_base);
}

std::vector<Tracker::Candidate>::iterator Tracker::AddToCandidates(const Rigid3& odom_from_base,
                                                                   const UncertainPose& answer,
                                                                   double max_sigmas) {
  const auto found =
      std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
        return Worst(candidate.track.GapTo(odom_from_base, answer)) <= max_sigmas;
      });
  if (found != candidates_.end()) {
    found->track.Take(odom_from_base, answer, options_.smooth);
    ++found->agreeing;
    return found;
  }
  // One wrong answer among those of a new place must not make the count begin again.
  if (static_cast<int>(candidates_.size()) == options_.agreeing_answers) {
    candidates_.erase(candidates_.begin());
  }
  candidates_.push_back({Track(options_.drift, odom_from_base, answer)});
  return candidates_.end() - 1;
}

Verdict Tracker::HoldBack(const std::optional<Gap>& gap) {
  ++held_in_a_row_;
  if (!gap) return Verdict::kUnconfirmed;
  return gap->position_sigmas > options_.max_sigmas ? Verdict::kPositionContradicted
                                                    : Verdict::kRotationContradicted;
}

}  // namespace maploc
