#include "tests/experiments/judged_answer.h"

#include <algorithm>

#include "server/pipeline/attempt.h"
#include "server/refinement/refine.h"

namespace maploc::experiments {
namespace {

const Camera& ImageCamera() {
  static const Camera camera =
      Camera::Create(CameraModel::kSimplePinhole, 640, 480, {500, 319.5, 239.5}).value();
  return camera;
}

// `iterations` were spent before.
JudgedAnswer Attempt(const PoseProblem& problem, bool gravity_was_sent, RansacOptions ransac,
                     int iterations) {
  JudgedAnswer answer;
  if (!problem.has_gravity) ransac.strategy = Strategy::kP3P;
  const Consensus consensus = EstimateConsensus(problem, ransac);
  answer.iterations = iterations + consensus.iterations;
  if (!consensus.found) return answer;
  const RefineOptions refine;
  const RefinedPose pose = RefinePose(problem, consensus.camera_from_map, refine);
  if (!pose.converged) return answer;
  TrustOptions trust;
  trust.gravity_was_sent = gravity_was_sent;
  trust.iterations = answer.iterations;
  answer.verdict = JudgePose(problem, pose, ImageCamera(), trust);
  answer.camera_from_map = answer.verdict.pose.camera_from_map;
  return answer;
}

}  // namespace

JudgedAnswer AnswerAsProduct(const PoseProblem& problem, Strategy strategy, std::uint64_t seed,
                             int min_iterations) {
  PoseProblem without = problem;
  without.has_gravity = false;
  RansacOptions ransac;
  ransac.strategy = strategy;
  ransac.seed = seed;
  ransac.min_iterations = min_iterations;
  if (strategy == Strategy::kP3P) return Attempt(without, false, ransac, 0);
  const JudgedAnswer answer = Attempt(problem, true, ransac, 0);
  if (answer.verdict.outcome == Outcome::kLocalized) return answer;
  ransac.max_iterations = kIterationsAgainstGravity;
  ransac.min_iterations = std::min(min_iterations, kIterationsAgainstGravity);
  const JudgedAnswer free = Attempt(without, true, ransac, answer.iterations);
  return free.verdict.outcome == Outcome::kLocalized ? free : answer;
}

Result<Strategy> ProductStrategy(const std::string& method) {
  constexpr std::string_view kAuto = "-auto";
  if (method == "p3p") return Strategy::kP3P;
  if (method.ends_with(kAuto)) {
    if (const auto strategy = StrategyFromName(method.substr(0, method.size() - kAuto.size()))) {
      return *strategy;
    }
  }
  return InvalidArgument("--methods", "'" + method +
                                          "' is no answer of the product's; choose 1p1l-auto, "
                                          "2p-auto, mixed-auto or p3p");
}

}  // namespace maploc::experiments
