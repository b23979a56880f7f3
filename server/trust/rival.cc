#include "server/trust/rival.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "server/ransac/estimator.h"
#include "server/ransac/stopping.h"
#include "server/solvers/reprojection.h"
#include "server/trust/determination.h"
#include "server/trust/visibility.h"

namespace maploc {
namespace {

constexpr std::uint64_t kSeed = 1;
// log10 of a rival's false alarms: it is suspected long before it would be believed itself.
constexpr double kMaxLogAlarms = 3.0;
constexpr double kFound = 0.999;
// InliersOfRival.
constexpr double kRivalShare = 0.4;
constexpr double kLeast = 5.0;
constexpr double kEnough = 20.0;
constexpr double kEnoughShare = 0.02;

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

std::size_t FeatureCount(const PoseProblem& problem) {
  return problem.points.size() + problem.lines.size();
}

// So near that both may be the tail of one pose's noise, or of the map's.
bool IsSamePose(const PoseProblem& problem, const RefinedPose& pose, const RefinedPose& rival) {
  const Rigid3& a = pose.camera_from_map;
  const Rigid3& b = rival.camera_from_map;
  const double apart = (a.Inverse().translation - b.Inverse().translation).norm();
  return RotationAngleBetween(a.rotation, b.rotation) < kMaxSpread.rotation_rad &&
         apart < kMaxSpread.position_share * MedianInlierDepth(problem, pose);
}

// What finds a pose of `needed` inliers, and no more: where little is left over, a rival would fill
// it, and is found soon or is not there. Twice that, for noise keeps some good draws from it.
int Iterations(const PoseProblem& problem, Strategy strategy, std::size_t needed) {
  const double share = static_cast<double>(needed) / static_cast<double>(FeatureCount(problem));
  InlierCounts counts;
  counts.points = static_cast<int>(problem.points.size());
  counts.usable_lines = static_cast<int>(problem.lines.size());
  counts.point_inliers = static_cast<int>(share * counts.points);
  counts.usable_line_inliers = static_cast<int>(share * counts.usable_lines);
  const int required = RequiredIterations(DrawProbability(strategy, counts), Yield(strategy),
                                          kFound, kRivalIterations);
  return std::min(2 * required, kRivalIterations);
}

std::optional<RefinedPose> BestPose(const PoseProblem& problem, bool with_gravity,
                                    std::size_t needed, double max_reprojection_error_px) {
  RansacOptions options;
  options.strategy = with_gravity ? Strategy::kMixed : Strategy::kP3P;
  options.fall_back = false;
  options.max_reprojection_error_px = max_reprojection_error_px;
  options.max_iterations = Iterations(problem, options.strategy, needed);
  options.seed = kSeed;
  const Consensus consensus = EstimateConsensus(problem, options);
  if (!consensus.found) return std::nullopt;
  RefineOptions refine;
  refine.mode = with_gravity ? Refinement::kAuto : Refinement::k6Dof;
  refine.max_reprojection_error_px = max_reprojection_error_px;
  RefinedPose pose = RefinePose(problem, consensus.camera_from_map, refine);
  if (!pose.converged) return std::nullopt;
  return pose;
}

// Of `left_over`, a pose that is told as a rival of `pose`: with `needed` inliers at least.
std::optional<RefinedPose> SearchRival(const PoseProblem& left_over, bool with_gravity,
                                       std::size_t needed, const ConfidenceOptions& options) {
  const std::optional<RefinedPose> rival =
      BestPose(left_over, with_gravity, needed, options.max_reprojection_error_px);
  if (!rival || rival->InlierCount() < needed) return std::nullopt;
  ConfidenceOptions chance = options;
  chance.iterations = kRivalIterations;
  chance.clump_share = 0.0;  // a door that is mistaken for another is what is looked for
  if (LogNumberOfFalseAlarms(left_over, *rival, chance) >= kMaxLogAlarms) return std::nullopt;
  return rival;
}

// What the camera saw with its x turned over. The sign of the pixel's x, which would turn over too,
// does not change the length of an error.
void Mirror(PixelFrame& frame) {
  frame.ray.x() *= -1.0;
  frame.across.col(0) *= -1.0;
}

// Turned over about the principal point: where that is off, the pose turns with it.
PoseProblem Mirrored(PoseProblem problem) {
  for (PointCorrespondence& point : problem.points) {
    point.normalized.x() *= -1.0;
    if (point.frame) Mirror(*point.frame);
  }
  for (LineCorrespondence& line : problem.lines) {
    line.normalized.start.x() *= -1.0;
    line.normalized.end.x() *= -1.0;
    if (!line.frames) continue;
    for (PixelFrame& frame : *line.frames) Mirror(frame);
  }
  return problem;
}

}  // namespace

std::size_t InliersOfCloseRival(std::size_t inliers) {
  return static_cast<std::size_t>(
      std::ceil(std::max(kLeast, kRivalShare * static_cast<double>(inliers))));
}

std::size_t InliersOfRival(std::size_t inliers, double sampled_share) {
  const double count = static_cast<double>(inliers);
  const double enough = std::max({kEnough * sampled_share, kEnoughShare * count, kLeast});
  return std::min(InliersOfCloseRival(inliers), static_cast<std::size_t>(std::ceil(enough)));
}

std::optional<RefinedPose> FindRival(const PoseProblem& problem, const RefinedPose& pose,
                                     std::size_t needed, const ConfidenceOptions& options) {
  const PoseProblem left_over = LeftOver(problem, pose);
  if (FeatureCount(left_over) < needed) return std::nullopt;
  std::optional<RefinedPose> best;
  for (const bool with_gravity : {true, false}) {
    if (with_gravity && !problem.has_gravity) continue;
    const auto rival = SearchRival(left_over, with_gravity, needed, options);
    if (!rival || IsSamePose(problem, pose, *rival)) continue;
    if (!best || rival->InlierCount() > best->InlierCount()) best = rival;
  }
  if (!best) return std::nullopt;
  // Told over all matches, because its inliers among those of the pose decide whether it is another
  // one (CastsDoubt in judge.cc).
  InlierFlags inliers =
      FindInliers(problem, best->camera_from_map, options.max_reprojection_error_px);
  best->point_inliers = std::move(inliers.points);
  best->line_inliers = std::move(inliers.lines);
  return best;
}

bool LooksMirrored(const PoseProblem& problem, const RefinedPose& pose,
                   const ConfidenceOptions& options) {
  const std::size_t needed = InliersOfCloseRival(pose.InlierCount());
  PoseProblem mirrored = LeftOver(problem, pose);
  if (FeatureCount(mirrored) < needed) return false;
  mirrored = Mirrored(std::move(mirrored));
  const auto rival = SearchRival(mirrored, false, needed, options);
  return rival && WithoutUnseen(mirrored, *rival).InlierCount() >= needed;
}

}  // namespace maploc
