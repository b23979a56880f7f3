#include "server/trust/judge.h"

#include "mapstore/geometry/line.h"
#include "mapstore/geometry/pixel_scale.h"
#include "server/trust/confidence.h"
#include "server/trust/rival.h"

namespace maploc {
namespace {

void Count(bool inlier, FeatureCounts& counts) {
  ++counts.matches;
  if (inlier) ++counts.inliers;
}

// Before there is a pose the flags are empty, and nothing is an inlier.
bool IsInlier(const std::vector<std::uint8_t>& inliers, std::size_t index) {
  return index < inliers.size() && inliers[index] != 0;
}

}  // namespace

Verdict JudgePose(const PoseProblem& problem, const RefinedPose& pose, const Camera& camera,
                  const JudgeOptions& options) {
  const double scale = PixelScale(camera);
  const ConfidenceOptions confidence{
      .max_reprojection_error_px = options.max_reprojection_error_px,
      .image_width_px = static_cast<int>(camera.width_px() / scale),
      .image_height_px = static_cast<int>(camera.height_px() / scale),
      .iterations = options.iterations,
  };
  Verdict verdict;
  verdict.confidence = PoseConfidence(problem, pose, confidence);
  if (verdict.confidence >= options.min_confidence && HasRival(problem, pose, confidence)) {
    verdict.confidence = options.min_confidence / 2;  // of two rivals one is wrong at least
  }
  if (verdict.confidence < options.min_confidence) {
    verdict.outcome = Outcome::kLowConfidence;
  } else if (options.contradicts_gravity) {
    verdict.outcome = Outcome::kGravityInconsistent;
  } else {
    verdict.outcome = Outcome::kLocalized;
  }
  return verdict;
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
