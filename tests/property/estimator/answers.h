// Many made-up problems through RANSAC, refinement and judgement, summed up.
#pragma once

#include <cstdio>
#include <numbers>
#include <vector>

#include "mapstore/base/median.h"
#include "server/ransac/estimator.h"
#include "server/refinement/refine.h"
#include "server/trust/judge.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {

inline constexpr double kDegree = std::numbers::pi / 180.0;

struct Answer {
  bool right = false;  // within 1.5 degrees and 0.15 units of a camera 3 to 5 away
  bool localized = false;
  PoseError error;
};

// `unit`: of the map, as a share of the synthetic problem's own.
inline Answer Estimate(const PoseProblem& problem, const Rigid3& truth, const Camera& camera,
                       std::uint64_t seed, double unit = 1.0) {
  Answer answer;
  RansacOptions options;
  options.seed = seed;
  options.max_iterations = 300;
  const Consensus consensus = EstimateConsensus(problem, options);
  if (!consensus.found) return answer;
  const RefinedPose pose = RefinePose(problem, consensus.camera_from_map, {});
  answer.error = ComparePoses(pose.camera_from_map, truth);
  answer.error.position /= unit;
  answer.right = answer.error.rotation_rad < 1.5 * kDegree && answer.error.position < 0.15;
  TrustOptions trust;
  trust.gravity_was_sent = problem.has_gravity;
  trust.iterations = consensus.iterations;
  answer.localized = JudgePose(problem, pose, camera, trust).outcome == Outcome::kLocalized;
  return answer;
}

struct Summary {
  double right = 0.0;
  double localized = 0.0;
  double rotation_rad = 0.0;  // medians
  double position = 0.0;
};

inline Summary Summarize(const char* name, const std::vector<Answer>& answers) {
  Summary summary;
  std::vector<double> rotations;
  std::vector<double> positions;
  for (const Answer& answer : answers) {
    summary.right += answer.right ? 1 : 0;
    summary.localized += answer.localized ? 1 : 0;
    rotations.push_back(answer.right ? answer.error.rotation_rad : 1e9);
    positions.push_back(answer.right ? answer.error.position : 1e9);
  }
  const double count = static_cast<double>(answers.size());
  summary.right /= count;
  summary.localized /= count;
  summary.rotation_rad = Median(rotations);
  summary.position = Median(positions);
  std::printf("%-24s right %.3f, localized %.3f, median %.3f deg %.4f\n", name, summary.right,
              summary.localized, summary.rotation_rad / kDegree, summary.position);
  return summary;
}

inline Camera VgaPinhole() {
  return Camera::Create(CameraModel::kPinhole, 640, 480, {500, 500, 320, 240}).value();
}

}  // namespace maploc::testing
