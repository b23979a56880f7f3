#include "server/ransac/search.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "server/ransac/local_optimizer.h"
#include "server/ransac/pretest.h"
#include "server/ransac/sampler.h"
#include "server/ransac/stopping.h"

namespace maploc {
namespace {

// A rejected draw is drawn again this often before the iteration counts as spent.
constexpr int kMaxRedraws = 10;
constexpr int kPollInterval = 16;  // iterations between two looks at the clock
// Of the first step of local optimization, in units of the inlier threshold; it also covers what
// gravity's error does to the features outside of the sample. The next steps narrow it down.
constexpr double kFirstThreshold = 4.0;
constexpr double kGravitySigmasOfFirst = 2.0;
constexpr double kMaxFirstThreshold = 16.0;

// Runners-up are optimized while the features looked at stay below so many an iteration.
constexpr double kRunnerUpFeatures = 3.0;
constexpr double kRunnerUpShare = 0.5;  // of the best sampled score
// While no sample scores more than its own features do, any is worth a try: where gravity is three
// sigmas off, an all-inlier sample explains nothing else before it is optimized.
constexpr double kScoreBesideSample = 0.2;

class Search {
 public:
  Search(const PreparedProblem& prepared, const RansacOptions& options, Strategy strategy,
         Random& random)
      : prepared_(prepared),
        options_(options),
        strategy_(strategy),
        random_(random),
        sampler_(prepared, strategy),
        threshold_(options.max_reprojection_error_px / prepared.centred.focal_length_px),
        scoring_{.threshold = static_cast<float>(threshold_),
                 .min_line_length =
                     static_cast<float>(kMinProjectedLinePx / prepared.centred.focal_length_px)},
        local_thresholds_(LocalThresholds()),
        pretest_(prepared, scoring_),
        optimizer_(prepared, strategy != Strategy::kP3P) {}

  SearchResult Run() {
    if (!sampler_.CanDraw()) return result_;
    result_.drawn = true;
    int required = options_.max_iterations;
    while (result_.iterations < required) {
      if (result_.iterations % kPollInterval == 0 && Interrupted()) {
        result_.interrupted = true;
        break;
      }
      ++result_.iterations;
      runner_up_features_ += kRunnerUpFeatures;
      if (Iterate()) required = Required();
    }
    return result_;
  }

 private:
  std::array<double, 4> LocalThresholds() const {
    const double sigma = strategy_ == Strategy::kP3P ? 0.0 : prepared_.centred.gravity_sigma_rad;
    const double first = std::hypot(kFirstThreshold * threshold_, kGravitySigmasOfFirst * sigma);
    return {std::min(kMaxFirstThreshold * threshold_, first), 2.0 * threshold_, threshold_,
            threshold_};
  }

  bool Interrupted() const {
    if (options_.cancelled != nullptr && options_.cancelled->load(std::memory_order_relaxed)) {
      return true;
    }
    return options_.deadline != kNoDeadline &&
           std::chrono::steady_clock::now() >= options_.deadline;
  }

  // One evaluated hypothesis. True when the best pose changed.
  bool Iterate() {
    const Hypotheses* drawn = &sampler_.Draw(random_);
    for (int i = 0; i < kMaxRedraws && drawn->count == 0; ++i) drawn = &sampler_.Draw(random_);
    bool improved = false;
    for (int i = 0; i < drawn->count; ++i) {
      improved |= Consider(drawn->sample, drawn->camera_from_centred[i]);
    }
    return improved;
  }

  bool Consider(const Sample& sample, const PoseMatrix& pose) {
    const ScoringPose scoring_pose = ToScoringPose(pose);
    if (!pretest_.Passes(sample, scoring_pose, random_)) return false;
    const Support support = Score(scoring_pose);
    const int own = sample.point_count + sample.line_count;
    if (!IsWorthOptimizing(support, own)) return false;
    if (support.score > best_sampled_score_) {
      best_sampled_score_ = support.score;
      pretest_.Update(support.score);
    }
    const bool kept = Keep(pose, support);
    const bool improved = OptimizeLocally(pose);  // also where the sample itself was not kept
    return kept || improved;
  }

  // A new best is, always. A runner-up is where it costs little: with few inliers, or gravity a
  // degree off, the true pose's samples score hardly more than chance before they are optimized.
  // `own`: features of the sample, which agree with its pose anyway.
  bool IsWorthOptimizing(const Support& support, int own) {
    if (support.score > best_sampled_score_) return true;
    const bool none_stands_out = best_sampled_score_ < own + kScoreBesideSample;
    if ((support.inliers <= own && !none_stands_out) ||
        support.score < kRunnerUpShare * best_sampled_score_ || runner_up_features_ <= 0) {
      return false;
    }
    runner_up_features_ -= static_cast<double>(prepared_.points.size() + prepared_.lines.size());
    return true;
  }

  Support Score(const ScoringPose& pose) const {
    Support support =
        ScorePoints(prepared_.point_arrays, 0, prepared_.point_arrays.x.size(), pose, scoring_);
    support += ScoreLines(prepared_.line_arrays, 0, prepared_.line_arrays.x.size(), pose, scoring_);
    return support;
  }

  bool Keep(const PoseMatrix& pose, const Support& support) {
    if (support.score <= result_.support.score) return false;
    result_.support = support;
    result_.camera_from_centred = pose;
    return true;
  }

  bool OptimizeLocally(PoseMatrix pose) {
    bool improved = false;
    for (const double threshold : local_thresholds_) {
      if (!optimizer_.Step(threshold, &pose)) break;
      improved |= Keep(pose, Score(ToScoringPose(pose)));
    }
    return improved;
  }

  int Required() const {
    const InlierCounts counts = CountInliers();
    return std::max(options_.min_iterations,
                    RequiredIterations(DrawProbability(strategy_, counts), Yield(strategy_),
                                       options_.success_confidence, options_.max_iterations));
  }

  InlierCounts CountInliers() const {
    const PoseMatrix& pose = result_.camera_from_centred;
    InlierCounts counts;
    counts.points = static_cast<int>(prepared_.points.size());
    for (const PointCorrespondence& point : prepared_.centred.points) {
      counts.point_inliers += IsPointInlier(pose, point, threshold_) ? 1 : 0;
    }
    counts.usable_lines = static_cast<int>(prepared_.usable_lines.size());
    counts.usable_line_inliers = CountLineInliers(prepared_.usable_lines);
    if (sampler_.draws_vertical_lines()) {
      counts.vertical_lines = static_cast<int>(prepared_.vertical_lines.size());
      counts.vertical_line_inliers = CountLineInliers(prepared_.vertical_lines);
    }
    return counts;
  }

  int CountLineInliers(const std::vector<std::uint32_t>& lines) const {
    int inliers = 0;
    for (const std::uint32_t index : lines) {
      inliers += IsLineInlier(result_.camera_from_centred, prepared_.centred.lines[index],
                              threshold_, scoring_.min_line_length)
                     ? 1
                     : 0;
    }
    return inliers;
  }

  const PreparedProblem& prepared_;
  const RansacOptions& options_;
  const Strategy strategy_;
  Random& random_;
  Sampler sampler_;
  const double threshold_;  // plane z = 1
  const ScoringOptions scoring_;
  const std::array<double, 4> local_thresholds_;  // of the steps of local optimization
  Pretest pretest_;
  LocalOptimizer optimizer_;
  // Of samples before local optimization: a sample is compared with its like.
  double best_sampled_score_ = 0.0;
  double runner_up_features_ = 0.0;  // that may still be looked at
  SearchResult result_;
};

}  // namespace

SearchResult SearchConsensus(const PreparedProblem& prepared, const RansacOptions& options,
                             Strategy strategy, Random& random) {
  return Search(prepared, options, strategy, random).Run();
}

}  // namespace maploc
