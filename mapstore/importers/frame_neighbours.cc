#include "mapstore/importers/frame_neighbours.h"

#include <algorithm>
#include <map>
#include <utility>

#include "mapstore/geometry/gravity.h"

namespace maploc {
namespace {

// A shared point seen under this parallax (4 degrees) counts fully.
constexpr double kFullAngleRad = 0.07;
// Between the optical axes, where there are no points: wider apart, photos share little.
constexpr double kMaxViewAngleRad = 1.0;

using Scores = std::vector<std::map<int, double>>;  // by frame, then by other frame

Scores ScoreBySharedPoints(std::span<const KeyFrame> frames, std::span<const PointTrack> points) {
  Scores scores(frames.size());
  for (const PointTrack& point : points) {
    std::vector<Eigen::Vector3d> rays;
    for (const std::int32_t frame : point.frames) {
      const Eigen::Vector3d center = frames[static_cast<std::size_t>(frame)].CenterInMap();
      rays.push_back((point.position_in_map - center).normalized());
    }
    for (std::size_t a = 0; a < rays.size(); ++a) {
      for (std::size_t b = a + 1; b < rays.size(); ++b) {
        const double weight = std::min(AngleBetween(rays[a], rays[b]) / kFullAngleRad, 1.0);
        scores[static_cast<std::size_t>(point.frames[a])][point.frames[b]] += weight;
        scores[static_cast<std::size_t>(point.frames[b])][point.frames[a]] += weight;
      }
    }
  }
  return scores;
}

Scores ScoreByPoses(std::span<const KeyFrame> frames) {
  Scores scores(frames.size());
  const auto axis = [&](std::size_t i) -> Eigen::Vector3d {
    return frames[i].camera_from_map.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  };
  for (std::size_t a = 0; a < frames.size(); ++a) {
    for (std::size_t b = 0; b < frames.size(); ++b) {
      const double distance = (frames[a].CenterInMap() - frames[b].CenterInMap()).norm();
      if (a == b || !(distance > 1e-9)) continue;
      if (AngleBetween(axis(a), axis(b)) <= kMaxViewAngleRad) {
        scores[a][static_cast<int>(b)] = 1.0 / distance;
      }
    }
  }
  return scores;
}

std::vector<int> Best(const std::map<int, double>& scores, int count) {
  std::vector<std::pair<double, int>> order;
  // Negative scores: ascending order then has the best first, and of equal ones the lower frame.
  for (const auto& [frame, score] : scores) order.emplace_back(-score, frame);
  std::sort(order.begin(), order.end());
  std::vector<int> best;
  for (const auto& entry : order) {
    if (static_cast<int>(best.size()) == count) break;
    best.push_back(entry.second);
  }
  return best;
}

}  // namespace

std::vector<std::vector<int>> FindFrameNeighbours(std::span<const KeyFrame> frames,
                                                  std::span<const PointTrack> points) {
  const Scores scores = points.empty() ? ScoreByPoses(frames) : ScoreBySharedPoints(frames, points);
  std::vector<std::vector<int>> neighbours;
  for (const auto& of_frame : scores) {
    neighbours.push_back(Best(of_frame, kMaxNeighbours));
  }
  for (std::size_t a = 0; a < neighbours.size(); ++a) {
    const std::vector<int> of_a = neighbours[a];
    for (const int b : of_a) {
      std::vector<int>& of_b = neighbours[static_cast<std::size_t>(b)];
      if (std::find(of_b.begin(), of_b.end(), static_cast<int>(a)) == of_b.end()) {
        of_b.push_back(static_cast<int>(a));
      }
    }
  }
  return neighbours;
}

}  // namespace maploc
