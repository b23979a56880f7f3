#include "server/trust/rival.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/ransac/estimator.h"
#include "server/solvers/reprojection.h"
#include "server/trust/determination.h"

namespace maploc {
namespace {

constexpr std::uint64_t kSeed = 1;
// log10 of a rival's false alarms: it is suspected long before it would be believed itself.
constexpr double kMaxLogAlarms = 3.0;

template <typename Correspondence>
std::vector<Correspondence> Outliers(const std::vector<Correspondence>& features,
                                     const std::vector<std::uint8_t>& inliers) {
  std::vector<Correspondence> outliers;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (inliers[i] == 0) outliers.push_back(features[i]);
  }
  return outliers;
}

// The problem with the features alone that do not agree with `pose`.
PoseProblem LeftOver(const PoseProblem& problem, const RefinedPose& pose) {
  PoseProblem part;
  part.focal_length_px = problem.focal_length_px;
  part.gravity_in_camera = problem.gravity_in_camera;
  part.gravity_sigma_rad = problem.gravity_sigma_rad;
  part.has_gravity = problem.has_gravity;
  part.points = Outliers(problem.points, pose.point_inliers);
  part.lines = Outliers(problem.lines, pose.line_inliers);
  return part;
}

// So near that both may be the tail of one pose's noise, or of the map's.
bool IsSamePose(const PoseProblem& problem, const RefinedPose& pose, const RefinedPose& rival) {
  const Rigid3& a = pose.camera_from_map;
  const Rigid3& b = rival.camera_from_map;
  const double apart = (a.Inverse().translation - b.Inverse().translation).norm();
  return RotationAngleBetween(a.rotation, b.rotation) < kMaxSpread.rotation_rad &&
         apart < kMaxSpread.position_share * MedianInlierDepth(problem, pose);
}

std::optional<RefinedPose> BestPose(const PoseProblem& problem, double max_reprojection_error_px) {
  RansacOptions options;
  options.strategy = problem.has_gravity ? Strategy::kMixed : Strategy::kP3P;
  options.fall_back = false;
  options.max_reprojection_error_px = max_reprojection_error_px;
  options.max_iterations = kRivalIterations;
  options.seed = kSeed;
  const Consensus consensus = EstimateConsensus(problem, options);
  if (!consensus.found) return std::nullopt;
  RefineOptions refine;
  refine.max_reprojection_error_px = max_reprojection_error_px;
  RefinedPose pose = RefinePose(problem, consensus.camera_from_map, refine);
  if (!pose.converged) return std::nullopt;
  return pose;
}

}  // namespace

bool HasRival(const PoseProblem& problem, const RefinedPose& pose,
              const ConfidenceOptions& options) {
  const double share = kRivalShare * static_cast<double>(pose.InlierCount());
  const std::size_t needed = std::max(kLeastRival, static_cast<std::size_t>(std::ceil(share)));
  const PoseProblem left_over = LeftOver(problem, pose);
  if (left_over.points.size() + left_over.lines.size() < needed) return false;
  const std::optional<RefinedPose> rival = BestPose(left_over, options.max_reprojection_error_px);
  if (!rival || rival->InlierCount() < needed) return false;
  if (IsSamePose(problem, pose, *rival)) return false;
  ConfidenceOptions chance = options;
  chance.iterations = kRivalIterations;
  chance.clump_share = 0.0;  // a door that is mistaken for another is what is looked for
  return LogNumberOfFalseAlarms(left_over, *rival, chance) < kMaxLogAlarms;
}

}  // namespace maploc
