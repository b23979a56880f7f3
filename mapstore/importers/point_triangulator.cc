#include "mapstore/importers/point_triangulator.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "mapstore/descriptors/knn.h"
#include "mapstore/importers/point_geometry.h"

namespace maploc {
namespace {

// Pixels are those of the photos as their features were found (KeyFrame::FeaturePixel).
constexpr double kMaxEpipolarErrorPx = 3.0;
constexpr double kMaxErrorPx = 2.0;  // of an observation that a point keeps
// Largest parallax of a point's rays (1.5 degrees). A point that only two frames saw has no third
// view that would contradict a wrong match: it needs more (4 degrees).
constexpr double kMinAngleRad = 0.026;
constexpr double kMinTwoViewAngleRad = 0.07;

struct FeatureRef {
  std::int32_t frame = 0;
  std::int32_t feature = 0;
  auto operator<=>(const FeatureRef&) const = default;
};

struct Edge {
  float ratio = 1.0f;
  FeatureRef a;
  FeatureRef b;
  auto operator<=>(const Edge&) const = default;
};

// The keypoints' rays; one without an undistorted position has none.
using FrameRays = std::vector<std::optional<Eigen::Vector2d>>;

FrameRays Undistort(const KeyFrame& frame, const PointFeatures& features) {
  FrameRays rays;
  for (const Eigen::Vector2f& pixel : features.keypoints_px) {
    rays.push_back(frame.camera.Normalize(pixel.cast<double>()));
  }
  return rays;
}

// Distance of b's ray from the epipolar line of a's, in b's pixels.
double EpipolarErrorPx(const Rigid3& b_from_a, const Eigen::Vector2d& in_a,
                       const Eigen::Vector2d& in_b, double focal_length_px) {
  const Eigen::Vector3d line =
      b_from_a.translation.cross(b_from_a.rotation * Eigen::Vector3d(in_a.x(), in_a.y(), 1.0));
  const double norm = line.head<2>().norm();
  // Without a baseline, or for a ray along it, there is no epipolar line that could refute the
  // match.
  if (!(norm > 0)) return 0.0;
  return focal_length_px * std::abs(line.dot(Eigen::Vector3d(in_b.x(), in_b.y(), 1.0))) / norm;
}

class Triangulator {
 public:
  Triangulator(std::span<const KeyFrame> frames, std::span<const PointFeatures> features)
      : frames_(frames), features_(features) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      rays_.push_back(Undistort(frames[i], features[i]));
    }
  }

  std::vector<Edge> MatchPair(int a, int b) const {
    const auto ia = static_cast<std::size_t>(a);
    const auto ib = static_cast<std::size_t>(b);
    std::vector<std::int32_t> rows(features_[ib].keypoints_px.size());
    std::iota(rows.begin(), rows.end(), 0);
    const Rigid3 b_from_a = frames_[ib].camera_from_map * frames_[ia].camera_from_map.Inverse();
    std::vector<Edge> edges;
    for (const FeatureMatch& m :
         MatchDescriptors(features_[ia].descriptors, features_[ib].descriptors, rows)) {
      const auto& ray_a = rays_[ia][static_cast<std::size_t>(m.feature)];
      const auto& ray_b = rays_[ib][static_cast<std::size_t>(m.landmark)];
      if (!ray_a || !ray_b) continue;
      const double error =
          EpipolarErrorPx(b_from_a, *ray_a, *ray_b, frames_[ib].FocalLengthInFeaturePixels());
      if (error <= kMaxEpipolarErrorPx) {
        edges.push_back({m.ratio, {a, m.feature}, {b, m.landmark}});
      }
    }
    return edges;
  }

  // Triangulates, drops the observations beyond the error allowed, and checks what is left.
  std::optional<PointTrack> Triangulate(std::vector<FeatureRef> members) const {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds && members.size() >= 2; ++round) {
      const std::vector<PointObservation> views = Observe(members);
      const std::optional<Eigen::Vector3d> point = TriangulatePoint(views);
      if (!point) return std::nullopt;
      std::vector<FeatureRef> kept;
      for (std::size_t i = 0; i < members.size(); ++i) {
        if (PointErrorPx(views[i], *point) <= kMaxErrorPx) kept.push_back(members[i]);
      }
      if (kept.size() == members.size()) return Accept(*point, views, members);
      members = std::move(kept);
    }
    return std::nullopt;
  }

 private:
  std::vector<PointObservation> Observe(const std::vector<FeatureRef>& members) const {
    std::vector<PointObservation> views;
    for (const FeatureRef& ref : members) {
      const KeyFrame& frame = frames_[static_cast<std::size_t>(ref.frame)];
      views.push_back(
          {frame.camera_from_map,
           *rays_[static_cast<std::size_t>(ref.frame)][static_cast<std::size_t>(ref.feature)],
           frame.FocalLengthInFeaturePixels()});
    }
    return views;
  }

  std::optional<PointTrack> Accept(const Eigen::Vector3d& point,
                                   const std::vector<PointObservation>& views,
                                   const std::vector<FeatureRef>& members) const {
    const double min_angle = members.size() == 2 ? kMinTwoViewAngleRad : kMinAngleRad;
    if (!(LargestParallax(views, point) >= min_angle)) return std::nullopt;
    PointTrack track{point, {}, {}};
    for (const FeatureRef& ref : members) {
      track.frames.push_back(ref.frame);
      const auto row = features_[static_cast<std::size_t>(ref.frame)].descriptors.row(ref.feature);
      track.descriptors.insert(track.descriptors.end(), row.begin(), row.end());
    }
    return track;
  }

  std::span<const KeyFrame> frames_;
  std::span<const PointFeatures> features_;
  std::vector<FrameRays> rays_;
};

// Joins features to tracks, the surest match first; two features of one frame never meet in one.
class TrackBuilder {
 public:
  void Join(const Edge& edge) {
    const int a = TrackOf(edge.a);
    const int b = TrackOf(edge.b);
    if (a == b) return;
    std::vector<FeatureRef>& into = tracks_[static_cast<std::size_t>(a)];
    std::vector<FeatureRef>& from = tracks_[static_cast<std::size_t>(b)];
    for (const FeatureRef& ref : from) {
      for (const FeatureRef& other : into) {
        if (other.frame == ref.frame) return;
      }
    }
    for (const FeatureRef& ref : from) track_of_[ref] = a;
    into.insert(into.end(), from.begin(), from.end());
    from.clear();
  }

  std::vector<std::vector<FeatureRef>> Take() {
    // The order in a track must not depend on which match joined it.
    for (std::vector<FeatureRef>& track : tracks_) std::sort(track.begin(), track.end());
    std::erase_if(tracks_, [](const std::vector<FeatureRef>& track) { return track.size() < 2; });
    return std::move(tracks_);
  }

 private:
  int TrackOf(const FeatureRef& ref) {
    const auto [entry, is_new] = track_of_.emplace(ref, static_cast<int>(tracks_.size()));
    if (is_new) tracks_.push_back({ref});
    return entry->second;
  }

  std::map<FeatureRef, int> track_of_;
  std::vector<std::vector<FeatureRef>> tracks_;
};

std::vector<Edge> MatchAll(const Triangulator& triangulator,
                           std::span<const std::vector<int>> neighbours,
                           const ProgressFn& progress) {
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t a = 0; a < neighbours.size(); ++a) {
    for (const int b : neighbours[a]) {
      // Neighbours are symmetric, so this takes each pair once.
      if (static_cast<int>(a) < b) pairs.emplace_back(static_cast<int>(a), b);
    }
  }
  std::vector<std::vector<Edge>> by_pair(pairs.size());
  const int count = static_cast<int>(pairs.size());
  ParallelFor(
      count,
      [&](int i) {
        const auto& [a, b] = pairs[static_cast<std::size_t>(i)];
        by_pair[static_cast<std::size_t>(i)] = triangulator.MatchPair(a, b);
      },
      [&](int done) {
        if (progress) progress("matching photos", done, count);
      });
  std::vector<Edge> edges;
  for (const auto& of_pair : by_pair) edges.insert(edges.end(), of_pair.begin(), of_pair.end());
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

std::vector<PointTrack> TriangulatePoints(std::span<const KeyFrame> frames,
                                          std::span<const PointFeatures> features,
                                          std::span<const std::vector<int>> neighbours,
                                          const ProgressFn& progress) {
  const Triangulator triangulator(frames, features);
  TrackBuilder builder;
  for (const Edge& edge : MatchAll(triangulator, neighbours, progress)) builder.Join(edge);
  std::vector<PointTrack> points;
  for (std::vector<FeatureRef>& members : builder.Take()) {
    std::optional<PointTrack> track = triangulator.Triangulate(std::move(members));
    if (track) points.push_back(std::move(*track));
  }
  return points;
}

}  // namespace maploc
