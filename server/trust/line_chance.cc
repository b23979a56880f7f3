// How often wrong line matches agree with a pose (chance.h).
#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "server/trust/chance.h"
#include "server/trust/outlier_pairs.h"

namespace maploc {
namespace {

constexpr double kLikeDirection = 0.98480775301220802;  // cosine of 10 degrees

// A line match under the pose: the seen segment, and where its landmark is seen. An image line is
// (unit normal, offset): normal . p + offset = 0.
struct LineUnderPose {
  LineSegment2 seen;
  Eigen::Vector3d seen_line = Eigen::Vector3d::Zero();
  Eigen::Vector3d projected_line = Eigen::Vector3d::Zero();
  bool projects = false;
  bool alike = false;  // seen and projected have like directions
  double shift = 0.0;  // of the seen segment's middle from the projected line; where alike
};

// Normals of like lines point alike: to the right, or down for level lines.
Eigen::Vector3d UnitLine(const Eigen::Vector3d& line) {
  const double norm = line.head<2>().norm();
  if (!(norm > 0)) return Eigen::Vector3d::Zero();
  const bool flip = std::abs(line.x()) > std::abs(line.y()) ? line.x() < 0 : line.y() < 0;
  return (flip ? -1.0 : 1.0) / norm * line;
}

bool AreAlike(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::abs(a.head<2>().dot(b.head<2>())) > kLikeDirection;
}

bool LiesOn(const LineSegment2& segment, const Eigen::Vector3d& line, double distance) {
  return std::abs(line.dot(segment.start.homogeneous())) < distance &&
         std::abs(line.dot(segment.end.homogeneous())) < distance;
}

Eigen::Vector3d LineThrough(const LineSegment2& segment) {
  return UnitLine(segment.start.homogeneous().cross(Eigen::Vector3d(segment.end.homogeneous())));
}

// What pairs of matches compare by where features have frames.
struct FramedLine {
  LineSegment2 seen;
  std::array<Eigen::Vector3d, 2> rays;  // of the seen end points
  std::array<Eigen::Matrix<double, 2, 3>, 2> gradients;
  Eigen::Vector3d moment;  // of the landmark in the camera
};

Eigen::Vector3d Moment(const LineCorrespondence& match, const PoseMatrix& pose) {
  const Eigen::Vector3d start = pose.rotation * match.segment_in_map.start + pose.translation;
  const Eigen::Vector3d along =
      pose.rotation * (match.segment_in_map.end - match.segment_in_map.start);
  return start.cross(along);
}

FramedLine Framed(const LineCorrespondence& match, const PoseMatrix& pose) {
  const auto& [first, last] = *match.frames;
  return {match.normalized,
          {first.ray, last.ray},
          {first.Gradient(), last.Gradient()},
          Moment(match, pose)};
}

std::vector<FramedLine> FramedLines(const std::vector<LineCorrespondence>& lines,
                                    const PoseMatrix& pose) {
  std::vector<FramedLine> framed;
  for (const LineCorrespondence& line : lines) {
    if (line.frames) framed.push_back(Framed(line, pose));
  }
  return framed;
}

// Where a landmark is seen about a feature. Without a plane z = 1 straight lines are curved: taken
// is the chord between the places nearest to the feature's end points.
Eigen::Vector3d ProjectedNear(const FramedLine& feature, const Eigen::Vector3d& moment) {
  LineSegment2 chord = feature.seen;
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector2d across = feature.gradients[i] * moment;
    if (!(across.squaredNorm() > 0)) return Eigen::Vector3d::Zero();
    (i == 0 ? chord.start : chord.end) -=
        moment.dot(feature.rays[i]) / across.squaredNorm() * across;
  }
  return LineThrough(chord);
}

LineUnderPose Look(const LineCorrespondence& match, const PoseMatrix& pose, double min_length) {
  LineUnderPose line;
  line.seen = match.normalized;
  line.seen_line = LineThrough(match.normalized);
  const Eigen::Vector3d moment = Moment(match, pose);
  line.projected_line =
      match.frames ? ProjectedNear(Framed(match, pose), moment) : UnitLine(moment);
  line.projects = !line.projected_line.isZero() && ProjectedLength(pose, match) >= min_length;
  line.alike = line.projects && AreAlike(line.seen_line, line.projected_line);
  const Eigen::Vector2d middle = 0.5 * (match.normalized.start + match.normalized.end);
  line.shift = line.projected_line.dot(middle.homogeneous());
  return line;
}

// What is seen on another's line is one with it.
bool AreApart(const LineUnderPose& a, const LineUnderPose& b, double threshold) {
  return !LiesOn(a.seen, b.seen_line, 2.0 * threshold);
}

int DistinctInliers(const std::vector<LineUnderPose>& lines,
                    const std::vector<std::uint8_t>& inliers, double threshold) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (inliers[i] == 0) continue;
    const bool is_new = std::ranges::all_of(
        kept, [&](std::size_t other) { return AreApart(lines[i], lines[other], threshold); });
    if (is_new) kept.push_back(i);
  }
  return static_cast<int>(kept.size());
}

// `framed`: of all lines, or of none.
PairCount WrongPairs(const std::vector<LineUnderPose>& lines, const std::vector<FramedLine>& framed,
                     const std::vector<std::uint8_t>& inliers, double threshold) {
  std::vector<std::size_t> outliers;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (inliers[i] == 0 && lines[i].projects) outliers.push_back(i);
  }
  const auto compare = [&](std::size_t i, std::size_t j, const Eigen::Vector3d& projected) {
    const bool is_pair = i != j && AreAlike(lines[i].seen_line, projected) &&
                         AreApart(lines[i], lines[j], threshold);
    return Tell(is_pair, is_pair && LiesOn(lines[i].seen, projected, threshold));
  };
  return CountWrongPairs(lines.size(), outliers, [&](std::size_t i, std::size_t j) {
    if (framed.empty()) return compare(i, j, lines[j].projected_line);
    return compare(i, j, ProjectedNear(framed[i], framed[j].moment));
  });
}

struct ShiftedLine {
  LineUnderPose line;
  double tolerance;
};

std::vector<ShiftedLine> ShiftedOutliers(const std::vector<LineUnderPose>& lines,
                                         const std::vector<std::uint8_t>& inliers,
                                         double threshold) {
  std::vector<ShiftedLine> outliers;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (inliers[i] != 0 || !lines[i].alike) continue;
    const double length = std::abs(lines[i].shift);
    if (!IsShifted(length, threshold)) continue;
    outliers.push_back({lines[i], ShiftTolerance(length, threshold)});
  }
  return outliers;
}

// Shifts that are uniform over an interval about 0 have its length squared / 12 as variance.
double RangeOfShifts(const std::vector<ShiftedLine>& outliers) {
  double sum2 = 0.0;
  for (const ShiftedLine& outlier : outliers) sum2 += outlier.line.shift * outlier.line.shift;
  return std::sqrt(12.0 * sum2 / std::max<double>(1.0, outliers.size()));
}

double SharedShift(const std::vector<LineUnderPose>& lines,
                   const std::vector<std::uint8_t>& inliers, double threshold) {
  const std::vector<ShiftedLine> outliers = ShiftedOutliers(lines, inliers, threshold);
  const double range = RangeOfShifts(outliers);
  const auto compare = [&](const ShiftedLine& one, const ShiftedLine& other) {
    const bool is_pair = AreAlike(one.line.seen_line, other.line.seen_line) &&
                         AreApart(one.line, other.line, threshold);
    return Tell(is_pair, std::abs(one.line.shift - other.line.shift) < one.tolerance);
  };
  return ShareOffAlike(outliers, compare,
                       [&](double tolerance) { return 2.0 * tolerance / range; });
}

}  // namespace

Agreement LineAgreement(const std::vector<LineCorrespondence>& lines,
                        const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                        double threshold, double min_length) {
  std::vector<LineUnderPose> under_pose;
  under_pose.reserve(lines.size());
  for (const LineCorrespondence& line : lines) under_pose.push_back(Look(line, pose, min_length));
  Agreement agreement;
  agreement.matches = static_cast<int>(lines.size());
  agreement.distinct_inliers = DistinctInliers(under_pose, inliers, threshold);
  agreement.wrong_pairs = WrongPairs(under_pose, FramedLines(lines, pose), inliers, threshold);
  agreement.shared_shift = SharedShift(under_pose, inliers, threshold);
  return agreement;
}

}  // namespace maploc
