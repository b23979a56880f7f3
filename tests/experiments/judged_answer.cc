#include "tests/experiments/judged_answer.h"

#include "server/ransac/estimator.h"
#include "server/refinement/refine.h"

namespace maploc::experiments {
namespace {

const Camera& ImageCamera() {
  static const Camera camera =
      Camera::Create(CameraModel::kSimplePinhole, 640, 480, {500, 319.5, 239.5}).value();
  return camera;
}

}  // namespace

JudgedAnswer AnswerAsProduct(PoseProblem problem, Strategy strategy, std::uint64_t seed) {
  if (strategy == Strategy::kP3P) problem.has_gravity = false;
  RansacOptions ransac;
  ransac.strategy = strategy;
  ransac.seed = seed;
  const Consensus consensus = EstimateConsensus(problem, ransac);
  JudgedAnswer answer;
  answer.iterations = consensus.iterations;
  if (!consensus.found) return answer;
  const RefinedPose pose = RefinePose(problem, consensus.camera_from_map, {});
  if (!pose.converged) return answer;
  JudgeOptions judge;
  judge.max_reprojection_error_px = ransac.max_reprojection_error_px;
  judge.iterations = consensus.iterations;
  answer.verdict = JudgePose(problem, pose, ImageCamera(), judge);
  answer.camera_from_map = pose.camera_from_map;
  return answer;
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
