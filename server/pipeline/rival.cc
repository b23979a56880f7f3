#include "server/pipeline/rival.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/ransac/estimator.h"
#include "server/solvers/reprojection.h"

namespace maploc {
namespace {

constexpr std::uint64_t kSeed = 1;

int CountSet(const std::vector<std::uint8_t>& flags) {
  return static_cast<int>(std::count(flags.begin(), flags.end(), 1));
}

template <typename Correspondence>
std::vector<Correspondence> Flagged(const std::vector<Correspondence>& features,
                                    const std::vector<std::uint8_t>& flags, std::uint8_t value) {
  std::vector<Correspondence> kept;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (flags[i] == value) kept.push_back(features[i]);
  }
  return kept;
}

// The problem with the features alone whose flag under `pose` is `value`.
PoseProblem Part(const PoseProblem& problem, const RefinedPose& pose, std::uint8_t value) {
  PoseProblem part;
  part.focal_length_px = problem.focal_length_px;
  part.gravity_in_camera = problem.gravity_in_camera;
  part.gravity_sigma_rad = problem.gravity_sigma_rad;
  part.has_gravity = problem.has_gravity;
  part.points = Flagged(problem.points, pose.point_inliers, value);
  part.lines = Flagged(problem.lines, pose.line_inliers, value);
  return part;
}

}  // namespace

bool HasRival(const PoseProblem& problem, const RefinedPose& pose,
              double max_reprojection_error_px) {
  const int inliers = CountSet(pose.point_inliers) + CountSet(pose.line_inliers);
  const int needed = std::max(kLeastRival, static_cast<int>(kRivalShare * inliers + 0.999));
  const PoseProblem left_over = Part(problem, pose, 0);
  if (static_cast<int>(left_over.points.size() + left_over.lines.size()) < needed) return false;
  RansacOptions options;
  options.strategy = problem.has_gravity ? Strategy::kMixed : Strategy::kP3P;
  options.fall_back = false;
  options.max_reprojection_error_px = max_reprojection_error_px;
  options.max_iterations = kRivalIterations;
  options.seed = kSeed;
  const Consensus rival = EstimateConsensus(left_over, options);
  if (!rival.found || CountSet(rival.point_inliers) + CountSet(rival.line_inliers) < needed) {
    return false;
  }
  const InlierFlags shared =
      FindInliers(Part(problem, pose, 1), rival.camera_from_map, max_reprojection_error_px);
  return 2 * shared.count < inliers;
}

}  // namespace maploc
