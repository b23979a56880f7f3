// Which inliers are evidence of their own, and how often wrong point matches agree with a pose
// (chance.h).
#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>

#include "server/trust/chance.h"
#include "server/trust/clumps.h"
#include "server/trust/outlier_pairs.h"

namespace maploc {
namespace {

constexpr double kFarAway = 1e9;
// Of a clump's width: features further apart are of two things.
constexpr double kClumpGapShare = 0.3;

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

// Features within two thresholds of each other are one.
bool AreApart(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double threshold) {
  return (a - b).squaredNorm() >= 4.0 * threshold * threshold;
}

// `framed`: of all points, or of none.
PairCount WrongPairs(const std::vector<PointUnderPose>& points,
                     const std::vector<FramedPoint>& framed,
                     const std::vector<std::uint8_t>& inliers, double threshold) {
  const double threshold2 = threshold * threshold;
  std::vector<std::size_t> outliers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (inliers[i] == 0) outliers.push_back(i);
  }
  const auto agrees = [&](std::size_t i, std::size_t j) {
    if (!framed.empty()) return AgreesWith(framed[i].frame, framed[j].in_camera, threshold2);
    return (points[i].seen - points[j].projected).squaredNorm() < threshold2;
  };
  return CountWrongPairs(points.size(), outliers, [&](std::size_t i, std::size_t j) {
    // A feature near that of the match sees the same thing, and its agreement is no accident.
    const bool apart = AreApart(points[i].seen, points[j].seen, threshold);  // false of i = j
    return Tell(apart, apart && agrees(i, j));
  });
}

struct ShiftedPoint {
  Eigen::Vector2d seen;
  Eigen::Vector2d shift;
  double tolerance;
};

std::vector<ShiftedPoint> ShiftedOutliers(const std::vector<PointUnderPose>& points,
                                          const std::vector<std::uint8_t>& inliers,
                                          double threshold) {
  std::vector<ShiftedPoint> outliers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (inliers[i] != 0 || !points[i].in_front) continue;
    const Eigen::Vector2d shift = points[i].seen - points[i].projected;
    const double length = shift.norm();
    if (!IsShifted(length, threshold)) continue;
    outliers.push_back({points[i].seen, shift, ShiftTolerance(length, threshold)});
  }
  return outliers;
}

double SharedShift(const std::vector<PointUnderPose>& points,
                   const std::vector<std::uint8_t>& inliers, double threshold) {
  const std::vector<ShiftedPoint> outliers = ShiftedOutliers(points, inliers, threshold);
  std::vector<Eigen::Vector2d> shifts;
  for (const ShiftedPoint& outlier : outliers) shifts.push_back(outlier.shift);
  const double area = std::max(SpreadArea(shifts), 1e-12);
  const auto compare = [&](const ShiftedPoint& one, const ShiftedPoint& other) {
    return Tell(AreApart(one.seen, other.seen, threshold),
                (one.shift - other.shift).squaredNorm() < one.tolerance * one.tolerance);
  };
  return ShareOffAlike(outliers, compare, [&](double tolerance) {
    return std::numbers::pi * (tolerance * tolerance) / area;
  });
}

}  // namespace

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
