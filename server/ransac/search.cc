#include "server/ransac/search.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "server/ransac/local_optimizer.h"
#include "server/ransac/stopping.h"

namespace maploc {
namespace {

// Share of all-inlier samples that lead to the pose: gates, noise and gravity spoil the others,
// local optimization repairs some (measured 0.4 to 0.8; README).
constexpr double kYield = 0.8;
// A rejected draw is drawn again this often before the iteration counts as spent.
constexpr int kMaxRedraws = 10;
constexpr int kPollInterval = 16;  // iterations between two looks at the clock
// Thresholds, in units of the inlier threshold, of the steps of local optimization.
constexpr double kLocalThresholds[] = {4.0, 2.0, 1.0, 1.0};
// A pose as good as the best so far has an inlier in the pre-test's block with 1 - exp(-3) = 95%.
constexpr double kBlockInliers = 3.0;

// Runners-up are optimized while the features looked at stay below so many an iteration.
constexpr double kRunnerUpFeatures = 3.0;
constexpr double kRunnerUpShare = 0.5;  // of the best sampled score
constexpr int kMinRunnerUpInliers = 3;  // one more than the sample

class Search {
 public:
  Search(const PreparedProblem& prepared, const RansacOptions& options, Strategy strategy,
         Random& random)
      : prepared_(prepared),
        options_(options),
        strategy_(strategy),
        random_(random),
        sampler_(prepared, strategy),
        threshold_(options.max_reprojection_error_px / prepared.centred.focal_length_px) {
    scoring_.threshold = static_cast<float>(threshold_);
    scoring_.min_line_length =
        static_cast<float>(kMinProjectedLinePx / prepared.centred.focal_length_px);
    block_ = prepared.point_arrays.x.size();
  }

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
  bool Interrupted() const {
    if (options_.cancelled != nullptr && options_.cancelled->load(std::memory_order_relaxed)) {
      return true;
    }
    return options_.deadline != kNoDeadline &&
           std::chrono::steady_clock::now() >= options_.deadline;
  }

  // One evaluated hypothesis. True when the best pose changed.
  bool Iterate() {
    Hypotheses hypotheses;
    for (int i = 0; i <= kMaxRedraws && hypotheses.count == 0; ++i) {
      hypotheses = sampler_.Draw(random_);
    }
    bool improved = false;
    for (int i = 0; i < hypotheses.count; ++i) {
      improved |= Consider(hypotheses, hypotheses.camera_from_centred[i]);
    }
    return improved;
  }

  bool Consider(const Hypotheses& sample, const PoseMatrix& pose) {
    const ScoringPose scoring_pose = ToScoringPose(pose);
    if (!PassesPretest(sample, scoring_pose)) return false;
    const Support support = Score(scoring_pose);
    if (!IsWorthOptimizing(support)) return false;
    const bool is_best = support.score > best_sampled_score_;
    if (is_best) {
      best_sampled_score_ = support.score;
      UpdateBlock(support);
    }
    const bool kept = Keep(pose, support);
    const bool improved = OptimizeLocally(pose);  // also where the sample itself was not kept
    return kept || improved;
  }

  // A new best is, always. A runner-up is where it costs little: with few inliers, or gravity a
  // degree off, the true pose's samples score hardly more than chance before they are optimized.
  bool IsWorthOptimizing(const Support& support) {
    if (support.score > best_sampled_score_) return true;
    if (support.inliers < kMinRunnerUpInliers ||
        support.score < kRunnerUpShare * best_sampled_score_ || runner_up_features_ <= 0) {
      return false;
    }
    runner_up_features_ -= static_cast<double>(prepared_.points.size() + prepared_.lines.size());
    return true;
  }

  // A fresh random block a hypothesis: a fixed one would judge all by the same few points. The
  // sample's own points agree anyway and do not count.
  bool PassesPretest(const Hypotheses& sample, const ScoringPose& pose) {
    const std::size_t size = prepared_.point_arrays.x.size();
    if (2 * block_ > size) return true;
    const std::uint32_t starts = static_cast<std::uint32_t>((size - block_) / kScoringPad + 1);
    const std::size_t begin = kScoringPad * random_.Below(starts);
    int own = 0;
    for (int i = 0; i < sample.sampled_points; ++i) {
      const std::size_t place = prepared_.place_in_arrays[sample.points[i]];
      own += place >= begin && place < begin + block_ ? 1 : 0;
    }
    return ScorePoints(prepared_.point_arrays, begin, begin + block_, pose, scoring_).inliers > own;
  }

  void UpdateBlock(const Support& sampled) {
    const double ratio = std::max(
        PointSupport(sampled) / std::max<double>(1.0, static_cast<double>(prepared_.points.size())),
        1e-9);
    const double needed = kBlockInliers / ratio / static_cast<double>(kScoringPad);
    const std::size_t size = prepared_.point_arrays.x.size();
    block_ = needed < static_cast<double>(size)
                 ? kScoringPad * static_cast<std::size_t>(std::ceil(needed))
                 : size;
  }

  // Lines are not in the block: only points count for its size.
  double PointSupport(const Support& sampled) const {
    return static_cast<double>(sampled.inliers - last_line_inliers_);
  }

  Support Score(const ScoringPose& pose) {
    const Support lines = ScoreLines(prepared_.line_arrays, pose, scoring_);
    last_line_inliers_ = lines.inliers;
    Support support =
        ScorePoints(prepared_.point_arrays, 0, prepared_.point_arrays.x.size(), pose, scoring_);
    support += lines;
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
    const int line_inliers = last_line_inliers_;
    for (const double factor : kLocalThresholds) {
      if (!OptimizationStep(prepared_.centred, factor * threshold_, strategy_ != Strategy::kP3P,
                            &pose)) {
        break;
      }
      improved |= Keep(pose, Score(ToScoringPose(pose)));
    }
    last_line_inliers_ = line_inliers;
    return improved;
  }

  int Required() const {
    const InlierCounts counts = CountInliers();
    return std::max(options_.min_iterations,
                    RequiredIterations(DrawProbability(strategy_, counts), kYield,
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

  int CountLineInliers(const std::vector<std::int32_t>& lines) const {
    int inliers = 0;
    for (const std::int32_t index : lines) {
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
  ScoringOptions scoring_;
  std::size_t block_;  // points of the pre-test; all of them: no pre-test
  double best_sampled_score_ = 0.0;
  double runner_up_features_ = 0.0;  // that may still be looked at
  int last_line_inliers_ = 0;
  SearchResult result_;
};

}  // namespace

SearchResult SearchConsensus(const PreparedProblem& prepared, const RansacOptions& options,
                             Strategy strategy, Random& random) {
  return Search(prepared, options, strategy, random).Run();
}

}  // namespace maploc
