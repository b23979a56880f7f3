#include "server/trust/judge.h"

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

#include "mapstore/geometry/line.h"
#include "mapstore/geometry/pixel_scale.h"
#include "server/trust/calibration.h"
#include "server/trust/chance.h"
#include "server/trust/confidence.h"
#include "server/trust/determination.h"
#include "server/trust/lens_search.h"
#include "server/trust/rival.h"
#include "server/trust/visibility.h"

namespace maploc {
namespace {

// A rival takes a pose's place with so many times its inliers; with fewer, nobody can tell which of
// the two is right.
constexpr double kClearlyMore = 1.5;
// Of the pose's own spread, for a rival with few inliers.
constexpr double kAsWide = 0.4;

void Count(bool inlier, FeatureCounts& counts) {
  ++counts.matches;
  if (inlier) ++counts.inliers;
}

// Before there is a pose the flags are empty, and nothing is an inlier.
bool IsInlier(const std::vector<std::uint8_t>& inliers, std::size_t index) {
  return index < inliers.size() && inliers[index] != 0;
}

PoseProblem WithGravity(PoseProblem problem, bool has_gravity) {
  problem.has_gravity = has_gravity;
  return problem;
}

ConfidenceOptions ChanceOptions(const Camera& camera, const TrustOptions& options) {
  const double scale = PixelScale(camera);
  ConfidenceOptions chance;
  chance.max_reprojection_error_px = options.refine.max_reprojection_error_px;
  // In pixels of a VGA-sized image, as everything in the problem.
  chance.image_width_px = static_cast<int>(camera.width_px() / scale);
  chance.image_height_px = static_cast<int>(camera.height_px() / scale);
  chance.iterations = options.iterations;
  return chance;
}

// One pose under judgement.
class Judge {
 public:
  Judge(const PoseProblem& problem, const Camera& camera, const TrustOptions& options)
      : problem_(problem),
        camera_(camera),
        options_(options),
        chance_(ChanceOptions(camera, options)) {}

  Verdict Run(const RefinedPose& found) {
    verdict_.pose = WithoutUnseen(problem_, found);
    verdict_.confidence = PoseConfidence(problem_, verdict_.pose, chance_);
    // A pose that has no chance to be told may still be rivalled by one that explains more.
    const bool has_rival = TakeBetterRival();
    verdict_.gravity = CheckGravity(WithGravity(problem_, options_.gravity_was_sent), verdict_.pose,
                                    options_.refine);
    Decide(has_rival);
    return std::move(verdict_);
  }

 private:
  bool IsBelieved() const { return verdict_.confidence >= options_.min_confidence; }

  std::size_t InliersThatRival() const {
    return InliersOfRival(verdict_.pose.InlierCount(), options_.sampled_share);
  }

  // A thing that was moved is compact, and what was not surrounds it: a rival with a small share of
  // the inliers counts where it spreads over as much of the image. It does not where most of its
  // inliers are the pose's too: then it is the same pose in a map that is bent.
  bool CastsDoubt(const RefinedPose& rival) const {
    const std::size_t inliers = rival.InlierCount();
    if (inliers >= InliersOfCloseRival(verdict_.pose.InlierCount())) return true;
    const std::vector<Eigen::Vector2d> own = PointsBesides(verdict_.pose, rival);
    return own.size() >= std::max(InliersThatRival(), inliers / 2) &&
           SpreadArea(own) > kAsWide * SpreadArea(PointsBesides(rival, verdict_.pose));
  }

  // Those that agree with `pose` and not with `other`.
  std::vector<Eigen::Vector2d> PointsBesides(const RefinedPose& other,
                                             const RefinedPose& pose) const {
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < problem_.points.size(); ++i) {
      if (!IsInlier(pose.point_inliers, i) || IsInlier(other.point_inliers, i)) continue;
      points.push_back(problem_.points[i].normalized);
    }
    return points;
  }

  // True where a rival is left that is neither clearly better nor clearly worse.
  bool TakeBetterRival() {
    // A pose that takes the place may have a rival itself, so there is a second round, in which
    // none takes the place any more.
    for (int i = 0; i < 2; ++i) {
      const auto rival = FindRival(problem_, verdict_.pose, InliersThatRival(), chance_);
      if (!rival) return false;
      const RefinedPose seen = WithoutUnseen(problem_, *rival);
      const double count = static_cast<double>(seen.InlierCount());
      if (i > 0 || count < kClearlyMore * static_cast<double>(verdict_.pose.InlierCount())) {
        return CastsDoubt(seen);
      }
      Take(*rival);
    }
    return false;
  }

  // Refined without gravity: whether gravity supports it is what is asked next.
  void Take(const RefinedPose& rival) {
    RefineOptions free = options_.refine;
    free.mode = Refinement::k6Dof;
    verdict_.is_rival = true;
    problem_ = WithGravity(std::move(problem_), false);
    verdict_.pose = WithoutUnseen(problem_, RefinePose(problem_, rival.camera_from_map, free));
    verdict_.confidence = PoseConfidence(problem_, verdict_.pose, chance_);
  }

  void Decide(bool has_rival) {
    verdict_.outcome = Outcome::kLowConfidence;
    if (!IsBelieved()) {
      verdict_.doubt = Doubt::kChance;
    } else if (!IsDeterminedByMatches()) {
      verdict_.doubt = Doubt::kUndetermined;
    } else if (has_rival) {
      verdict_.doubt = Doubt::kRival;
    } else if (LooksMirrored(problem_, verdict_.pose, chance_)) {
      verdict_.doubt = Doubt::kMirrored;
    } else if (problem_.has_gravity && !verdict_.gravity.consistent) {
      verdict_.doubt = Doubt::kGravity;
      verdict_.outcome = Outcome::kGravityInconsistent;
    } else if (!IsCalibrated()) {
      verdict_.doubt = Doubt::kCalibration;
      verdict_.outcome = Outcome::kCalibrationInconsistent;
    } else {
      verdict_.doubt = Doubt::kNone;
      verdict_.outcome = Outcome::kLocalized;
    }
  }

  // Gravity may lie: it makes a pose better, but no more than half of what is known of the pose, in
  // any direction, may be gravity's word.
  bool IsDeterminedByMatches() const {
    const PoseSpread twice_the_variance = {
        .rotation_rad = std::numbers::sqrt2 * kMaxSpread.rotation_rad,
        .position_share = std::numbers::sqrt2 * kMaxSpread.position_share};
    const double threshold_px = chance_.max_reprojection_error_px;
    return IsDetermined(problem_, verdict_.pose, threshold_px, kMaxSpread) &&
           IsDetermined(WithGravity(problem_, false), verdict_.pose, threshold_px,
                        twice_the_variance);
  }

  bool IsCalibrated() {
    const bool believes_gravity = options_.gravity_was_sent && verdict_.gravity.consistent;
    const PoseProblem problem = WithGravity(problem_, believes_gravity);
    const double threshold_px = chance_.max_reprojection_error_px;
    const CalibrationCheck check = CheckCalibration(problem, verdict_.pose, threshold_px);
    verdict_.focal_scale = check.focal_scale;
    verdict_.pose.covariance += check.covariance;
    const bool rejects_gravity = options_.gravity_was_sent && !believes_gravity;
    return check.consistent && !AgreesBetterThroughAnotherLens(problem, verdict_.pose, camera_,
                                                               rejects_gravity, threshold_px);
  }

  PoseProblem problem_;
  const Camera& camera_;
  const TrustOptions& options_;
  const ConfidenceOptions chance_;
  Verdict verdict_;
};

}  // namespace

Verdict JudgePose(const PoseProblem& problem, const RefinedPose& found, const Camera& camera,
                  const TrustOptions& options) {
  return Judge(problem, camera, options).Run(found);
}

bool LinesAreAtChance(const PoseProblem& problem, const RefinedPose& pose, const Camera& camera,
                      const TrustOptions& options) {
  return LinesAgreeByChance(problem, pose, ChanceOptions(camera, options));
}

Evidence CountEvidence(const PoseProblem& problem, const RefinedPose& pose) {
  Evidence evidence;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    Count(IsInlier(pose.point_inliers, i), evidence.points);
  }
  for (std::size_t i = 0; i < problem.lines.size(); ++i) {
    const bool usable = IsUsableLine(problem.lines[i].segment_in_map);
    Count(IsInlier(pose.line_inliers, i), usable ? evidence.usable_lines : evidence.vertical_lines);
  }
  return evidence;
}

}  // namespace maploc
