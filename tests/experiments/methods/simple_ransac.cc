#include "tests/experiments/methods/simple_ransac.h"

#include <algorithm>

#include "server/ransac/local_optimizer.h"
#include "server/ransac/stopping.h"

namespace maploc::experiments {
namespace {

constexpr double kLocalThresholds[] = {4.0, 2.0, 1.0, 1.0};  // the product's

class Loop {
 public:
  Loop(const PoseProblem& problem, const MethodOptions& options, const DrawAndSolve& draw,
       const DrawChance& chance)
      : options_(options),
        draw_(draw),
        chance_(chance),
        random_(options.seed),
        prepared_(PrepareProblem(problem, random_)),
        threshold_(options.threshold_px / problem.focal_length_px),
        scoring_{
            .threshold = static_cast<float>(threshold_),
            .min_line_length = static_cast<float>(kMinProjectedLinePx / problem.focal_length_px)},
        optimizer_(prepared_, false) {}

  int Run() {
    int iterations = 0;
    int required = options_.max_iterations;
    while (iterations < required) {
      ++iterations;
      if (Iterate()) required = Required();
    }
    return iterations;
  }
  std::optional<Rigid3> Best() const {
    if (best_score_ <= 0) return std::nullopt;
    return UncentredPose(prepared_, best_);
  }

 private:
  bool Iterate() {
    PoseMatrix poses[kMaxSolutions];
    int count = 0;
    for (int i = 0; i <= kMaxRedraws && count == 0; ++i) count = draw_(prepared_, random_, poses);
    bool improved = false;
    for (int i = 0; i < count; ++i) improved |= Consider(poses[i]);
    return improved;
  }
  bool Consider(PoseMatrix pose) {
    if (!Keep(pose)) return false;
    for (const double factor : kLocalThresholds) {
      if (!optimizer_.Step(factor * threshold_, &pose)) break;
      Keep(pose);
    }
    return true;
  }
  bool Keep(const PoseMatrix& pose) {
    const ScoringPose scoring_pose = ToScoringPose(pose);
    const PointArrays& points = prepared_.point_arrays;
    const LineArrays& lines = prepared_.line_arrays;
    const double score = ScorePoints(points, 0, points.x.size(), scoring_pose, scoring_).score +
                         ScoreLines(lines, 0, lines.x.size(), scoring_pose, scoring_).score;
    if (!(score > best_score_)) return false;
    best_score_ = score;
    best_ = pose;
    return true;
  }
  int Required() const {
    const PoseProblem& problem = prepared_.centred;
    const auto points = std::ranges::count_if(
        problem.points, [&](const auto& point) { return IsPointInlier(best_, point, threshold_); });
    const auto lines = std::ranges::count_if(problem.lines, [&](const auto& line) {
      return IsLineInlier(best_, line, threshold_, scoring_.min_line_length);
    });
    const double chance = chance_(static_cast<int>(problem.points.size()), static_cast<int>(points),
                                  static_cast<int>(problem.lines.size()), static_cast<int>(lines));
    return std::max(options_.min_iterations,
                    RequiredIterations(chance, 1.0, options_.confidence, options_.max_iterations));
  }

  const MethodOptions& options_;
  const DrawAndSolve& draw_;
  const DrawChance& chance_;
  Random random_;
  const PreparedProblem prepared_;
  const double threshold_;  // plane z = 1
  const ScoringOptions scoring_;
  LocalOptimizer optimizer_;
  double best_score_ = 0.0;
  PoseMatrix best_;
};

}  // namespace

std::optional<Rigid3> SimpleRansac(const PoseProblem& problem, const MethodOptions& options,
                                   const DrawAndSolve& draw, const DrawChance& chance,
                                   int* iterations) {
  Loop loop(problem, options, draw, chance);
  *iterations = loop.Run();
  return loop.Best();
}

void DrawDistinct(std::uint32_t size, int count, Random& random, std::uint32_t* indices) {
  for (int i = 0; i < count; ++i) {
    do {
      indices[i] = random.Below(size);
    } while (std::find(indices, indices + i, indices[i]) != indices + i);
  }
}

}  // namespace maploc::experiments
