#include "server/matching/pose_problem.h"

namespace maploc {
namespace {

// What is known of a landmark; where the map does not know it, the value that says so.
template <typename Value>
Value KnownOrDefault(const std::vector<Value>& values, std::int32_t landmark) {
  return values.empty() ? Value{} : values[landmark];
}

void AddPoint(const FeatureMatch& match, const View& view, const Segment& segment,
              MatchedProblem& matched) {
  const Eigen::Vector2d pixel = view.points.keypoints_px[match.feature].cast<double>();
  const std::optional<Eigen::Vector2d> normalized = view.camera.Normalize(pixel);
  if (!normalized) return;
  const PointLandmarks& points = segment.points;
  matched.matches.points.push_back(match);
  matched.problem.points.push_back({*normalized, points.positions_in_map[match.landmark],
                                    static_cast<double>(match.ratio),
                                    KnownOrDefault(points.position_covariances, match.landmark),
                                    KnownOrDefault(points.viewing, match.landmark)});
}

void AddLine(const FeatureMatch& match, const View& view, const Segment& segment,
             MatchedProblem& matched) {
  const auto normalize = [&](const Eigen::Vector2f& pixel) {
    return view.camera.Normalize(pixel.cast<double>());
  };
  const std::optional<Eigen::Vector2d> start = normalize(view.lines.starts_px[match.feature]);
  const std::optional<Eigen::Vector2d> end = normalize(view.lines.ends_px[match.feature]);
  if (!start || !end || *start == *end) return;
  matched.matches.lines.push_back(match);
  matched.problem.lines.push_back(
      {LineSegment2{*start, *end}, segment.lines.segments_in_map[match.landmark],
       static_cast<double>(match.ratio), KnownOrDefault(segment.lines.viewing, match.landmark)});
}

}  // namespace

MatchedProblem BuildPoseProblem(const Matches& matches, const View& view, const Segment& segment,
                                const std::optional<Gravity>& gravity) {
  MatchedProblem matched;
  PoseProblem& problem = matched.problem;
  problem.focal_length_px = view.camera.MeanFocalLengthPx();
  problem.has_gravity = gravity.has_value();
  if (gravity) {
    const Eigen::Quaterniond& camera_from_body = view.camera_from_body.rotation;
    problem.gravity_in_camera = (camera_from_body * gravity->direction_in_body).normalized();
    problem.gravity_sigma_rad = gravity->sigma_rad;
  }
  for (const FeatureMatch& match : matches.points) AddPoint(match, view, segment, matched);
  for (const FeatureMatch& match : matches.lines) AddLine(match, view, segment, matched);
  return matched;
}

}  // namespace maploc
