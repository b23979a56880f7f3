#include "server/trust/chance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/LU>

#include "server/trust/clumps.h"
#include "server/trust/outlier_pairs.h"

namespace maploc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFarAway = 1e9;
constexpr double kAccidents = 2.0;
// Of a clump's width: features further apart are of two things.
constexpr double kClumpGapShare = 0.3;

double LogChoose(int n, int k) {
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
}

// A point match under the pose.
struct PointUnderPose {
  Eigen::Vector2d seen;
  Eigen::Vector2d projected;  // far away where it is not in front
  bool in_front = false;
};

// What pairs of matches compare by where features have frames.
struct FramedPoint {
  PixelFrame frame;           // of what is seen
  Eigen::Vector3d in_camera;  // the landmark
};

Eigen::Vector3d InCamera(const PointCorrespondence& match, const PoseMatrix& pose) {
  return pose.rotation * match.position_in_map + pose.translation;
}

// How far off the frame's pixel a point is seen, over the whole sphere: along its arc by the scale
// that the frame has, which is exact near by and of the right size far away.
Eigen::Vector2d OffsetOf(const PixelFrame& frame, const Eigen::Vector3d& in_camera) {
  const double depth = frame.ray.dot(in_camera);
  const Eigen::Vector3d across = in_camera - depth * frame.ray;
  const double sine = across.norm();
  if (!(sine > 0)) return Eigen::Vector2d::Zero();
  return frame.across * across * (std::atan2(sine, depth) / sine);
}

PointUnderPose Look(const PointCorrespondence& match, const PoseMatrix& pose) {
  const Eigen::Vector3d q = InCamera(match, pose);
  if (match.frame) {
    return {match.normalized, match.normalized + OffsetOf(*match.frame, q), true};
  }
  if (q.z() > 0) return {match.normalized, q.hnormalized(), true};
  return {match.normalized, Eigen::Vector2d::Constant(kFarAway), false};
}

std::vector<FramedPoint> FramedPoints(const std::vector<PointCorrespondence>& points,
                                      const PoseMatrix& pose) {
  std::vector<FramedPoint> framed;
  for (const PointCorrespondence& point : points) {
    if (point.frame) framed.push_back({*point.frame, InCamera(point, pose)});
  }
  return framed;
}

// Whether the landmark of the one agrees with the feature of the other.
bool AgreesWith(const PixelFrame& feature, const Eigen::Vector3d& landmark, double threshold2) {
  const double depth = feature.ray.dot(landmark);
  return depth > 0 && (feature.across * landmark).squaredNorm() < threshold2 * depth * depth;
}

// Inliers of which no two are closer together than the threshold, greedily from left to right.
std::vector<Eigen::Vector2d> DistinctInliers(const std::vector<PointUnderPose>& points,
                                             const std::vector<std::uint8_t>& inliers,
                                             double threshold) {
  std::vector<Eigen::Vector2d> seen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (inliers[i] != 0) seen.push_back(points[i].seen);
  }
  std::sort(seen.begin(), seen.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Eigen::Vector2d> kept;
  for (const Eigen::Vector2d& point : seen) {
    bool is_new = true;
    for (auto other = kept.rbegin(); is_new && other != kept.rend(); ++other) {
      if (point.x() - other->x() >= threshold) break;
      is_new = (point - *other).squaredNorm() >= threshold * threshold;
    }
    if (is_new) kept.push_back(point);
  }
  return kept;
}

// Of the features that are seen apart from an outlier's, those that `agrees` with its landmark.
template <typename Agrees>
PairCount CountPairs(const std::vector<PointUnderPose>& points,
                     const std::vector<std::size_t>& features, const PointUnderPose& outlier,
                     double threshold2, const Agrees& agrees) {
  PairCount count;
  for (const std::size_t i : features) {  // itself is not apart from itself
    const bool apart = (points[i].seen - outlier.seen).squaredNorm() >= 4.0 * threshold2;
    count.pairs += apart ? 1 : 0;
    count.agreeing += apart && agrees(i) ? 1 : 0;
  }
  return count;
}

// `framed`: of all points, or of none.
PairCount WrongPairs(const std::vector<PointUnderPose>& points,
                     const std::vector<FramedPoint>& framed,
                     const std::vector<std::uint8_t>& inliers, double threshold) {
  const double threshold2 = threshold * threshold;
  std::vector<std::size_t> outliers;  // an inlier's place is taken by its own feature
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (inliers[i] == 0) outliers.push_back(i);
  }
  const std::vector<std::size_t> features = SpreadIndices(points.size(), kMostFeatures);
  PairCount count;
  std::vector<std::int64_t> per_landmark;
  for (const std::size_t index : SpreadIndices(outliers.size(), kMostLandmarks)) {
    const std::size_t j = outliers[index];
    const PointUnderPose outlier = points[j];
    const auto in_plane = [&](std::size_t i) {
      return (points[i].seen - outlier.projected).squaredNorm() < threshold2;
    };
    const auto by_frame = [&](std::size_t i) {
      return AgreesWith(framed[i].frame, framed[j].in_camera, threshold2);
    };
    const PairCount of_landmark = framed.empty()
                                      ? CountPairs(points, features, outlier, threshold2, in_plane)
                                      : CountPairs(points, features, outlier, threshold2, by_frame);
    count.pairs += of_landmark.pairs;
    per_landmark.push_back(of_landmark.agreeing);
  }
  count.agreeing = AgreeingByRepetition(per_landmark);
  return count;
}

double SharedShift(const std::vector<PointUnderPose>& points,
                   const std::vector<std::uint8_t>& inliers, double threshold) {
  struct Outlier {
    Eigen::Vector2d seen;
    Eigen::Vector2d shift;
  };
  std::vector<Outlier> outliers;
  std::vector<Eigen::Vector2d> shifts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d shift = points[i].seen - points[i].projected;
    if (inliers[i] != 0 || !points[i].in_front) continue;
    if (shift.norm() < kNearMissThresholds * threshold) continue;
    outliers.push_back({points[i].seen, shift});
    shifts.push_back(shift);
  }
  const double area = std::max(SpreadArea(shifts), 1e-12);
  PairCount count;
  double expected = 0.0;  // pairs alike by accident
  const std::vector<std::size_t> looked_at = SpreadIndices(outliers.size(), kMostShifts);
  for (std::size_t a = 0; a < looked_at.size(); ++a) {
    const Outlier& one = outliers[looked_at[a]];
    const double tolerance =
        std::max(std::numbers::sqrt2 * threshold, kPerspectiveShare * one.shift.norm());
    const double tolerance2 = tolerance * tolerance;
    std::int64_t pairs = 0;
    for (std::size_t b = a + 1; b < looked_at.size(); ++b) {
      const Outlier& other = outliers[looked_at[b]];
      const bool apart = (one.seen - other.seen).squaredNorm() >= 4.0 * threshold * threshold;
      const bool agree = (one.shift - other.shift).squaredNorm() < tolerance2;
      pairs += apart ? 1 : 0;
      count.agreeing += apart && agree ? 1 : 0;
    }
    count.pairs += pairs;
    expected += static_cast<double>(pairs) * std::min(1.0, std::numbers::pi * tolerance2 / area);
  }
  return ShareOfPattern(count, expected);
}

}  // namespace

double LogBinomialTail(int n, int k, double p) {
  if (k <= 0) return 0.0;
  if (k > n || p <= 0) return -kInfinity;
  if (p >= 1) return 0.0;
  const double log_p = std::log(p);
  const double log_q = std::log1p(-p);
  double largest = -kInfinity;
  std::vector<double> terms;
  for (int i = k; i <= n; ++i) {
    terms.push_back(LogChoose(n, i) + i * log_p + (n - i) * log_q);
    largest = std::max(largest, terms.back());
    // Past the mode the terms fall at least geometrically: the rest is below rounding.
    if (i > n * p && terms.back() < largest - 40.0) break;
  }
  double sum = 0.0;
  for (const double term : terms) sum += std::exp(term - largest);
  return std::min((largest + std::log(sum)) / std::log(10.0), 0.0);
}

double CombineLogPValues(double log_p1, double log_p2) {
  const double log_product = log_p1 + log_p2;
  if (log_product == -kInfinity) return -kInfinity;
  return std::min(log_product + std::log10(1.0 - log_product * std::log(10.0)), 0.0);
}

double ShareBeyondAccident(const PairCount& count, double expected_share) {
  const double expected = expected_share * static_cast<double>(count.pairs);
  const double agreeing = static_cast<double>(count.agreeing);
  if (agreeing <= expected + 3.0 * std::sqrt(expected) + 2.0) return expected_share;
  return agreeing / static_cast<double>(count.pairs);
}

std::int64_t AgreeingByRepetition(const std::vector<std::int64_t>& per_landmark) {
  std::int64_t all = 0;
  std::int64_t landmarks = 0;  // with any
  for (const std::int64_t agreeing : per_landmark) {
    all += agreeing;
    landmarks += agreeing > 0 ? 1 : 0;
  }
  const double count = static_cast<double>(per_landmark.size());
  if (count == 0) return 0;
  const std::int64_t excess = all - landmarks;
  const double share = std::min(static_cast<double>(landmarks) / count, 1.0 - 0.5 / count);
  const double excess_of_pattern = (-std::log1p(-share) - share) * count;
  const bool exchanged = static_cast<double>(excess) + kAccidents < 0.5 * excess_of_pattern;
  return exchanged ? excess : all;
}

Agreement PointAgreement(const std::vector<PointCorrespondence>& points,
                         const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                         double threshold, double clump_width) {
  std::vector<PointUnderPose> under_pose;
  under_pose.reserve(points.size());
  for (const PointCorrespondence& point : points) under_pose.push_back(Look(point, pose));
  Agreement agreement;
  agreement.matches = static_cast<int>(points.size());
  agreement.distinct_inliers = CountByClumps(DistinctInliers(under_pose, inliers, threshold),
                                             kClumpGapShare * clump_width, clump_width);
  agreement.wrong_pairs = WrongPairs(under_pose, FramedPoints(points, pose), inliers, threshold);
  agreement.shared_shift = SharedShift(under_pose, inliers, threshold);
  return agreement;
}

double SpreadArea(const std::vector<Eigen::Vector2d>& features) {
  if (features.size() < 3) return 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& feature : features) mean += feature;
  mean /= static_cast<double>(features.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& feature : features) {
    covariance += (feature - mean) * (feature - mean).transpose();
  }
  covariance /= static_cast<double>(features.size());
  // A side of length a has variance a^2 / 12.
  return 12.0 * std::sqrt(std::max(covariance.determinant(), 0.0));
}

}  // namespace maploc
