#include "server/matching/pose_problem.h"

#include <array>

#include "mapstore/geometry/pixel_scale.h"

namespace maploc {
namespace {

// From where a landmark was seen. Unknown for a map that was made without it: `viewing` is empty.
ViewingRange ViewingOf(const std::vector<ViewingRange>& viewing, std::int32_t landmark) {
  return viewing.empty() ? ViewingRange{} : viewing[landmark];
}

// Where a feature is seen, as PointCorrespondence has it.
struct Seen {
  Eigen::Vector2d place;
  std::optional<PixelFrame> frame;
};

// The camera that turns pixels into Seen.
struct Eye {
  const Camera& camera;
  double focal_length_px;  // its own: in the plane z = 1 lengths are pixels over this one, too
  bool wide;
};

std::optional<Seen> See(const Eye& eye, const Eigen::Vector2f& pixel_px) {
  const auto& [camera, focal, wide] = eye;
  const Eigen::Vector2d pixel = pixel_px.cast<double>();
  if (!wide) {
    const std::optional<Eigen::Vector2d> normalized = camera.Normalize(pixel);
    return normalized ? std::optional<Seen>({*normalized, std::nullopt}) : std::nullopt;
  }
  std::optional<PixelFrame> frame = camera.Frame(pixel);
  if (!frame) return std::nullopt;
  frame->across /= focal;
  return Seen{(pixel - camera.principal_point_px()) / focal, frame};
}

void AddPoint(const FeatureMatch& match, const Eye& eye, const View& view, const Segment& segment,
              MatchedProblem& matched) {
  const std::optional<Seen> seen = See(eye, view.points.keypoints_px[match.feature]);
  if (!seen) return;
  matched.matches.points.push_back(match);
  const PointLandmarks& points = segment.points;
  matched.problem.points.push_back({seen->place, points.positions_in_map[match.landmark],
                                    static_cast<double>(match.ratio),
                                    ViewingOf(points.viewing, match.landmark), seen->frame});
}

void AddLine(const FeatureMatch& match, const Eye& eye, const View& view, const Segment& segment,
             MatchedProblem& matched) {
  const std::optional<Seen> start = See(eye, view.lines.starts_px[match.feature]);
  const std::optional<Seen> end = See(eye, view.lines.ends_px[match.feature]);
  if (!start || !end || start->place == end->place) return;
  matched.matches.lines.push_back(match);
  std::optional<std::array<PixelFrame, 2>> frames;
  if (start->frame) frames = {{*start->frame, *end->frame}};
  matched.problem.lines.push_back(
      {LineSegment2{start->place, end->place}, segment.lines.segments_in_map[match.landmark],
       static_cast<double>(match.ratio), ViewingOf(segment.lines.viewing, match.landmark), frames});
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
  const Eye eye{view.camera, view.camera.MeanFocalLengthPx(), view.camera.IsWide()};
  for (const FeatureMatch& match : matches.points) AddPoint(match, eye, view, segment, matched);
  for (const FeatureMatch& match : matches.lines) AddLine(match, eye, view, segment, matched);
  return matched;
}

}  // namespace maploc
