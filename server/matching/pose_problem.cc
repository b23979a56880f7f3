#include "server/matching/pose_problem.h"

#include "mapstore/geometry/pixel_scale.h"

namespace maploc {
namespace {

// Where a feature is seen, as PointCorrespondence has it.
struct Seen {
  Eigen::Vector2d place;
  std::optional<PixelFrame> frame;
};

std::optional<Seen> See(const Camera& camera, const Eigen::Vector2f& pixel_px, double focal) {
  const Eigen::Vector2d pixel = pixel_px.cast<double>();
  if (!camera.IsWide()) {
    const std::optional<Eigen::Vector2d> normalized = camera.Normalize(pixel);
    return normalized ? std::optional<Seen>({*normalized, std::nullopt}) : std::nullopt;
  }
  std::optional<PixelFrame> frame = camera.Frame(pixel);
  if (!frame) return std::nullopt;
  frame->across /= focal;
  return Seen{(pixel - camera.principal_point_px()) / focal, frame};
}

void AddPoint(const FeatureMatch& match, const View& view, const Segment& segment,
              MatchedProblem& matched) {
  const std::optional<Seen> seen =
      See(view.camera, view.points.keypoints_px[match.feature], matched.problem.focal_length_px);
  if (!seen) return;
  matched.matches.points.push_back(match);
  matched.problem.points.push_back({seen->place, segment.points.positions_in_map[match.landmark],
                                    static_cast<double>(match.ratio), seen->frame});
}

void AddLine(const FeatureMatch& match, const View& view, const Segment& segment,
             MatchedProblem& matched) {
  const auto see = [&](const Eigen::Vector2f& pixel) {
    return See(view.camera, pixel, matched.problem.focal_length_px);
  };
  const std::optional<Seen> start = see(view.lines.starts_px[match.feature]);
  const std::optional<Seen> end = see(view.lines.ends_px[match.feature]);
  if (!start || !end || start->place == end->place) return;
  matched.matches.lines.push_back(match);
  LineCorrespondence line{LineSegment2{start->place, end->place},
                          segment.lines.segments_in_map[match.landmark],
                          static_cast<double>(match.ratio)};
  if (start->frame) line.frames = {{*start->frame, *end->frame}};
  matched.problem.lines.push_back(line);
}

}  // namespace

MatchedProblem BuildPoseProblem(const Matches& matches, const View& view, const Segment& segment,
                                const std::optional<Gravity>& gravity) {
  MatchedProblem matched;
  PoseProblem& problem = matched.problem;
  problem.focal_length_px = view.camera.MeanFocalLengthPx() / PixelScale(view.camera);
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
