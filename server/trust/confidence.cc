#include "server/trust/confidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "mapstore/geometry/pixel_scale.h"
#include "server/trust/chance.h"

namespace maploc {
namespace {

// Features that the pose's six degrees of freedom explain by themselves.
constexpr int kFeaturesOfPose = 3;
// Poses tried per iteration: two solutions, and those that local optimization tries near the best.
constexpr double kPosesPerIteration = 20.0;
constexpr int kMinIterations = 100;
// From log10 of the number of false alarms to the log odds that the pose is right: what was
// observed where one query in thirty has any true match and the others are mostly facades of
// repeated patterns (MEASUREMENTS.md: the table, and how it was made). 0.99 is at 10^-5.5. Linear
// between the knots.
struct Knot {
  double log_false_alarms;
  double log_odds;
};
constexpr std::array<Knot, 6> kCalibration = {
    {{-12.0, 9.2}, {-5.5, 4.5952}, {-2.0, 2.3}, {0.0, 0.55}, {2.0, -2.3}, {3.5, -5.6}}};
// log10 of the probability that so many wrong lines agree by chance: above it a kind is at the
// level of chance. A kind that is there for nothing passes one time in a hundred.
constexpr double kLogChanceOfLines = -2.0;
// Pairs of outliers share a displacement less often than a pattern's commonest one occurs.
constexpr double kRepeatFactor = 3.0;
// How often a wrong line agrees where nothing is known: in buildings one in ten, by so many pairs.
constexpr double kLinePrior = 0.1;
constexpr double kLinePriorPairs = 60.0;

// The share of the image that one inlier's disc or strip covers.
struct ChanceRates {
  double point = 1.0;
  double line = 1.0;
};

ChanceRates RatesFromAreas(const PoseProblem& problem, double threshold, double image_area) {
  std::vector<Eigen::Vector2d> features;
  for (const PointCorrespondence& point : problem.points) features.push_back(point.normalized);
  const double spread = SpreadArea(features);
  const double point_area = features.size() >= 3 ? std::min(spread, image_area) : image_area;
  ChanceRates rates;
  rates.point =
      std::min(1.0, std::numbers::pi * threshold * threshold / std::max(point_area, 1e-30));
  // Parallel lines, as a building's are: only the position across counts.
  rates.line = std::min(1.0, 2.0 * threshold / std::sqrt(image_area));
  return rates;
}

// Shifts near zero are the most frequent of a repeated pattern.
double ChanceOfPoint(const Agreement& points, double from_area) {
  return std::min(1.0, std::max(ShareBeyondAccident(points.wrong_pairs, from_area),
                                kRepeatFactor * points.shared_shift));
}

// As for points; and few like lines tell nothing: then it is `kLinePrior`.
double ChanceOfLine(const Agreement& lines, double from_area, double shared_shift_of_points) {
  const double shared = kRepeatFactor * std::max(lines.shared_shift, shared_shift_of_points);
  const double guarded =
      (static_cast<double>(lines.wrong_pairs.agreeing) + kLinePriorPairs * kLinePrior) /
      (static_cast<double>(lines.wrong_pairs.pairs) + kLinePriorPairs);
  return std::min(1.0,
                  std::max({ShareBeyondAccident(lines.wrong_pairs, from_area), shared, guarded}));
}

double LogOdds(double log_false_alarms) {
  if (log_false_alarms <= kCalibration.front().log_false_alarms) {
    return kCalibration.front().log_odds;
  }
  for (std::size_t i = 1; i < kCalibration.size(); ++i) {
    const Knot& a = kCalibration[i - 1];
    const Knot& b = kCalibration[i];
    if (log_false_alarms > b.log_false_alarms) continue;
    const double share =
        (log_false_alarms - a.log_false_alarms) / (b.log_false_alarms - a.log_false_alarms);
    return a.log_odds + share * (b.log_odds - a.log_odds);
  }
  return kCalibration.back().log_odds;
}

// One kind of matches under a pose, and how often a wrong one agrees.
struct KindAgreement {
  Agreement agreement;
  double rate = 1.0;
};

struct Agreements {
  KindAgreement points;
  KindAgreement lines;
};

Agreements Agree(const PoseProblem& problem, const RefinedPose& pose,
                 const ConfidenceOptions& options) {
  const double focal = problem.focal_length_px;
  const double threshold = options.max_reprojection_error_px / focal;
  const double image_area = options.image_width_px / focal * (options.image_height_px / focal);
  const double diagonal_px = std::hypot(options.image_width_px, options.image_height_px);
  const double clump_width = options.clump_share * std::min(diagonal_px, kVgaDiagonalPx) / focal;
  const PoseMatrix matrix(pose.camera_from_map);
  const Agreement points =
      PointAgreement(problem.points, pose.point_inliers, matrix, threshold, clump_width);
  const Agreement lines = LineAgreement(problem.lines, pose.line_inliers, matrix, threshold,
                                        kMinProjectedLinePx / focal);
  const ChanceRates rates = RatesFromAreas(problem, threshold, image_area);
  return {{points, ChanceOfPoint(points, rates.point)},
          {lines, ChanceOfLine(lines, rates.line, points.shared_shift)}};
}

// `used` features are explained by the pose's own freedom.
double LogTail(const KindAgreement& kind, int used) {
  return LogBinomialTail(kind.agreement.matches - used, kind.agreement.distinct_inliers - used,
                         kind.rate);
}

}  // namespace

double LogNumberOfFalseAlarms(const PoseProblem& problem, const RefinedPose& pose,
                              const ConfidenceOptions& options) {
  const auto& [points, lines] = Agree(problem, pose, options);
  const int used_points = std::min(kFeaturesOfPose, points.agreement.distinct_inliers);
  const int used_lines = std::min(kFeaturesOfPose - used_points, lines.agreement.distinct_inliers);
  const double tests = kPosesPerIteration * std::max(options.iterations, kMinIterations);
  return std::log10(tests) +
         CombineLogPValues(LogTail(points, used_points), LogTail(lines, used_lines));
}

double ConfidenceOf(double log_false_alarms) {
  return 1.0 / (1.0 + std::exp(-LogOdds(log_false_alarms)));
}

double PoseConfidence(const PoseProblem& problem, const RefinedPose& pose,
                      const ConfidenceOptions& options) {
  if (!pose.converged) return 0.0;
  const double doubt = problem.has_gravity ? 0.0 : kDoubtWithoutGravity;
  return ConfidenceOf(LogNumberOfFalseAlarms(problem, pose, options) + doubt);
}

bool LinesAgreeByChance(const PoseProblem& problem, const RefinedPose& pose,
                        const ConfidenceOptions& options) {
  const Agreements found = Agree(problem, pose, options);
  if (problem.lines.empty()) return false;
  return found.lines.agreement.distinct_inliers == 0 ||
         LogBinomialTail(found.lines.agreement.matches, found.lines.agreement.distinct_inliers,
                         found.lines.rate) > kLogChanceOfLines;
}

}  // namespace maploc
