#include "server/ransac/stopping.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace maploc {
namespace {

double Ratio(double numerator, double denominator) {
  // Callers take the drawn feature off: without an inlier the numerator is -1.
  return denominator > 0 ? std::max(numerator, 0.0) / denominator : 0.0;
}

}  // namespace

double DrawProbability(Strategy strategy, const InlierCounts& counts) {
  const double first = Ratio(counts.point_inliers, counts.points);
  // A vertical line asks for a second one.
  const double vertical_pairs = counts.vertical_line_inliers *
                                Ratio(counts.vertical_line_inliers - 1, counts.vertical_lines - 1);
  const double lines = counts.usable_lines + counts.vertical_lines;
  const double good_lines = counts.usable_line_inliers + vertical_pairs;
  switch (strategy) {
    case Strategy::k1P1L:
      return first * Ratio(good_lines, lines);
    case Strategy::k2P:
      return first * Ratio(counts.point_inliers - 1, counts.points - 1);
    case Strategy::kMixed:
      return first * Ratio(counts.point_inliers - 1 + good_lines, counts.points - 1 + lines);
    case Strategy::kP3P:
      return first * Ratio(counts.point_inliers - 1, counts.points - 1) *
             Ratio(counts.point_inliers - 2, counts.points - 2);
  }
  return 0.0;
}

double Yield(Strategy strategy) { return strategy == Strategy::kP3P ? 1.0 : 1.2; }

int RequiredIterations(double draw_probability, double yield, double confidence,
                       int max_iterations) {
  const double success = std::clamp(draw_probability * yield, 0.0, 1.0);
  if (success <= 0) return max_iterations;
  if (success >= 1) return 1;
  // log1p, because 1 - success rounds to 1 for the smallest successes.
  const double needed = std::log1p(-confidence) / std::log1p(-success);
  // Clamped before the cast: at a small success more are needed than an int counts.
  return static_cast<int>(std::clamp(std::ceil(needed), 1.0, static_cast<double>(max_iterations)));
}

int Patience(Strategy strategy, double predicted_success, int max_iterations) {
  constexpr double kAllButSure = 0.999;
  constexpr int kTimes = 4;
  constexpr int kLeast = 200;
  if (strategy == Strategy::kMixed || predicted_success <= 0) return max_iterations;
  const int expected = RequiredIterations(predicted_success, 1.0, kAllButSure, max_iterations);
  const auto patience = std::max<std::int64_t>(kLeast, std::int64_t{kTimes} * expected);
  return static_cast<int>(std::min<std::int64_t>(patience, max_iterations));
}

}  // namespace maploc
