#include "tests/property/statistics/season.h"

#include <algorithm>
#include <cmath>

#include "mapstore/statistics/statistics.h"

namespace maploc::testing {
namespace {

double Varied(double value, double relative, Random& random) {
  return std::clamp(value * (1.0 + relative * random.Gaussian()), 0.0, 1.0);
}

FeatureCounts CountMatches(int typical, double ratio, Random& random) {
  FeatureCounts counts;
  const double share = 0.75 + 0.5 * random.Uniform();
  counts.matches = static_cast<std::int32_t>(std::lround(typical * share));
  for (int i = 0; i < counts.matches; ++i) counts.inliers += random.Uniform() < ratio ? 1 : 0;
  return counts;
}

double RatioOf(const FeatureCounts& counts) {
  return counts.matches > 0 ? static_cast<double>(counts.inliers) / counts.matches : 0.0;
}

bool Finds(Strategy strategy, const Evidence& evidence, int iterations, Random& random) {
  const StrategyValues iteration = IterationProbabilities(
      {static_cast<double>(evidence.points.matches),
       static_cast<double>(evidence.usable_lines.matches), 0.0},
      {RatioOf(evidence.points), RatioOf(evidence.usable_lines), 0.0}, SampleYields{});
  return random.Uniform() < 1.0 - std::pow(1.0 - iteration.Of(strategy), iterations);
}

// A failed search leaves the best of its wrong poses, which few matches agree with by chance.
void RejectPose(Evidence& evidence, Random& random) {
  evidence.points.inliers =
      std::min<std::int32_t>(evidence.points.matches, 2 + static_cast<int>(random.Below(3)));
  evidence.usable_lines.inliers =
      std::min<std::int32_t>(evidence.usable_lines.matches, static_cast<int>(random.Below(3)));
}

Observation Ask(const Season& season, const Robots& robots, const StrategyDecision& decision,
                Random& random) {
  Observation observation;
  observation.segment = 0;
  Evidence& evidence = observation.evidence;
  evidence.points = CountMatches(
      robots.points, Varied(season.point_inlier_ratio, robots.query_noise, random), random);
  evidence.usable_lines = CountMatches(
      robots.usable_lines, Varied(season.line_inlier_ratio, robots.query_noise, random), random);
  for (const Strategy strategy : decision.ranking) {
    evidence.strategy = strategy;
    evidence.fell_back = strategy != decision.strategy;
    if (Finds(strategy, evidence, robots.max_iterations, random)) {
      observation.outcome = Outcome::kLocalized;
      return observation;
    }
    if (!robots.fall_back) break;
  }
  RejectPose(evidence, random);
  observation.outcome = Outcome::kLowConfidence;
  return observation;
}

}  // namespace

SegmentSessionRow RunSession(int number, const Season& season, const Robots& robots,
                             const StrategyDecision& decision, Random& random) {
  constexpr std::int64_t kDayNanos = 86'400'000'000'000;
  constexpr std::int64_t kFirstNanos = 1'788'000'000'000'000'000;  // August 2026
  Session session;
  session.id = "s" + std::to_string(1000 + number);
  session.start_unix_ns = kFirstNanos + number * kDayNanos;
  const Season day = {Varied(season.point_inlier_ratio, robots.session_noise, random),
                      Varied(season.line_inlier_ratio, robots.session_noise, random)};
  std::vector<Observation> observations;
  for (int i = 1; i <= robots.queries; ++i) {
    observations.push_back(Ask(day, robots, decision, random));
    observations.back().sequence = i;
  }
  return FoldObservations(session, observations).front();
}

}  // namespace maploc::testing
