#include "server/refinement/chance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/LU>

namespace maploc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxPairSide = 250;
// Displacements by the same distance in the map differ in the image by about this share.
constexpr double kPerspectiveShare = 0.05;
// Outliers that lie this close are the tail of the same pose's noise and of badly triangulated
// landmarks, and all alike in that; a pattern repeats at larger steps.
constexpr double kNearMissThresholds = 4.0;

double LogChoose(int n, int k) {
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
}

// Every step-th index, so that at most kMaxPairSide are left.
std::size_t Step(std::size_t count) { return (count + kMaxPairSide - 1) / kMaxPairSide; }

Eigen::Vector3d ImageLine(const LineSegment2& segment) {
  const Eigen::Vector3d line = segment.start.homogeneous().cross(segment.end.homogeneous());
  const double norm = line.head<2>().norm();
  return norm > 0 ? Eigen::Vector3d(line / norm) : line;
}

bool LiesOn(const LineSegment2& segment, const Eigen::Vector3d& image_line, double distance) {
  return std::abs(image_line.dot(segment.start.homogeneous())) < distance &&
         std::abs(image_line.dot(segment.end.homogeneous())) < distance;
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

Agreement PointAgreement(const std::vector<PointCorrespondence>& points,
                         const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                         double threshold) {
  Agreement agreement;
  agreement.matches = static_cast<int>(points.size());
  std::vector<Eigen::Vector2d> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (inliers[i] == 0) continue;
    const Eigen::Vector2d& seen = points[i].normalized;
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](const Eigen::Vector2d& other) {
      return (other - seen).squaredNorm() < threshold * threshold;
    });
    if (is_new) kept.push_back(seen);
  }
  agreement.distinct_inliers = static_cast<int>(kept.size());

  const double apart2 = 4.0 * threshold * threshold;
  const std::size_t step = Step(points.size());
  for (std::size_t j = 0; j < points.size(); j += step) {
    if (inliers[j] != 0) continue;  // its place is taken by its own feature
    const Eigen::Vector3d q = pose.rotation * points[j].position_in_map + pose.translation;
    const bool in_front = q.z() > 0;
    const Eigen::Vector2d projected = in_front ? Eigen::Vector2d(q.hnormalized()) : q.head<2>();
    for (std::size_t i = 0; i < points.size(); i += step) {
      if (i == j) continue;
      const Eigen::Vector2d& seen = points[i].normalized;
      if ((seen - points[j].normalized).squaredNorm() < apart2) continue;
      ++agreement.wrong_pairs.pairs;
      agreement.wrong_pairs.agreeing +=
          in_front && (seen - projected).squaredNorm() < threshold * threshold ? 1 : 0;
    }
  }
  return agreement;
}

Agreement LineAgreement(const std::vector<LineCorrespondence>& lines,
                        const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                        double threshold, double min_length) {
  Agreement agreement;
  agreement.matches = static_cast<int>(lines.size());
  std::vector<Eigen::Vector3d> image_lines;
  for (const LineCorrespondence& line : lines) image_lines.push_back(ImageLine(line.normalized));
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (inliers[i] == 0) continue;
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](std::size_t other) {
      return LiesOn(lines[i].normalized, image_lines[other], 2.0 * threshold);
    });
    if (is_new) kept.push_back(i);
  }
  agreement.distinct_inliers = static_cast<int>(kept.size());

  const std::size_t step = Step(lines.size());
  for (std::size_t j = 0; j < lines.size(); j += step) {
    if (inliers[j] != 0) continue;
    // Where landmark j is seen under the pose; an empty line when it is not.
    const Eigen::Vector3d start = pose.rotation * lines[j].segment_in_map.start + pose.translation;
    const Eigen::Vector3d along =
        pose.rotation * (lines[j].segment_in_map.end - lines[j].segment_in_map.start);
    const Eigen::Vector3d moment = start.cross(along);
    const double norm = moment.head<2>().norm();
    const bool visible = norm > 0 && std::max(start.z(), start.z() + along.z()) > 0 &&
                         ProjectedLength(pose, lines[j].segment_in_map) >= min_length;
    for (std::size_t i = 0; i < lines.size(); i += step) {
      if (i == j || LiesOn(lines[i].normalized, image_lines[j], 2.0 * threshold)) continue;
      ++agreement.wrong_pairs.pairs;
      agreement.wrong_pairs.agreeing +=
          visible && LiesOn(lines[i].normalized, moment / norm, threshold) ? 1 : 0;
    }
  }
  return agreement;
}

double SharedDisplacementRate(const std::vector<PointCorrespondence>& points,
                              const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                              double threshold) {
  struct Outlier {
    Eigen::Vector2d seen;
    Eigen::Vector2d displacement;
  };
  std::vector<Outlier> outliers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d q = pose.rotation * points[i].position_in_map + pose.translation;
    if (inliers[i] != 0 || q.z() <= 0) continue;
    const Eigen::Vector2d displacement = points[i].normalized - q.hnormalized();
    if (displacement.norm() < kNearMissThresholds * threshold) continue;
    outliers.push_back({points[i].normalized, displacement});
  }
  std::vector<Eigen::Vector2d> displacements;
  for (const Outlier& outlier : outliers) displacements.push_back(outlier.displacement);
  const double area = std::max(SpreadArea(displacements), 1e-12);
  PairCount count;
  double expected = 0.0;  // pairs alike by accident
  const std::size_t step = Step(outliers.size());
  for (std::size_t i = 0; i < outliers.size(); i += step) {
    const double tolerance = std::max(std::numbers::sqrt2 * threshold,
                                      kPerspectiveShare * outliers[i].displacement.norm());
    for (std::size_t j = i + step; j < outliers.size(); j += step) {
      const double apart2 = (outliers[i].seen - outliers[j].seen).squaredNorm();
      if (apart2 < 4.0 * threshold * threshold) continue;
      ++count.pairs;
      expected += std::min(1.0, std::numbers::pi * tolerance * tolerance / area);
      const double difference = (outliers[i].displacement - outliers[j].displacement).norm();
      count.agreeing += difference < tolerance ? 1 : 0;
    }
  }
  if (count.pairs == 0) return 0.0;
  const double accident = expected / static_cast<double>(count.pairs);
  const double share = ShareBeyondAccident(count, accident);
  return share > accident ? share : 0.0;
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
