// A made-up scene for importer tests: a facade of known points and lines, photographed (without
// pixels) by cameras on a walk along it.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/importers/line_triangulator.h"
#include "mapstore/importers/tracks.h"

namespace maploc::testing {

// z up; cameras at y = -8 look along +y at a wall of some relief at y = 0.
struct DrawnScene {
  std::vector<KeyFrame> frames;
  std::vector<LineSegment3> lines;
  std::vector<std::vector<std::uint8_t>> line_rows;  // one descriptor a line
};

inline KeyFrame MakeFrame(int index, const Eigen::Vector3d& center) {
  const Camera camera = *Camera::Create(CameraModel::kPinhole, 1000, 800, {800, 800, 500, 400});
  Eigen::Matrix3d camera_from_map;  // x right is map x, y down is -z, z forward is y
  camera_from_map << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const Eigen::Quaterniond rotation(camera_from_map);
  return {
      index + 1, "img" + std::to_string(index) + ".jpg", camera, {rotation, -(rotation * center)}};
}

inline DrawnScene MakeScene(Random& random, int frames, int lines) {
  DrawnScene scene;
  for (int i = 0; i < frames; ++i) {
    scene.frames.push_back(MakeFrame(i, {0.8 * i, -8 + 0.1 * i, 1.5 + 0.15 * (i % 3)}));
  }
  for (int i = 0; i < lines; ++i) {
    const Eigen::Vector3d start(random.Uniform(-1, 0.8 * frames), random.Uniform(-1, 1),
                                random.Uniform(0, 3));
    const double tilt = random.Uniform(0.3, std::numbers::pi - 0.3);  // not along the walk
    const Eigen::Vector3d along(std::cos(tilt), random.Uniform(-0.3, 0.3), std::sin(tilt));
    scene.lines.push_back({start, start + random.Uniform(0.8, 1.6) * along});
    std::vector<std::uint8_t> row;
    for (int b = 0; b < 32; ++b) row.push_back(static_cast<std::uint8_t>(random.Below(256)));
    scene.line_rows.push_back(row);
  }
  return scene;
}

// What a frame sees: each line cut by up to a fifth at either end, with noise across it and some
// bits of its descriptor flipped. Lines out of the image are not seen.
inline FrameLines SeeLines(const DrawnScene& scene, std::size_t frame, double noise_px,
                           Random& random) {
  FrameLines seen;
  seen.descriptors.kind = *DescriptorKindFromName("lbd");
  const KeyFrame& key_frame = scene.frames[frame];
  for (std::size_t i = 0; i < scene.lines.size(); ++i) {
    const LineSegment3& line = scene.lines[i];
    const Eigen::Vector3d along = line.end - line.start;
    const auto see = [&](double share) {
      const Eigen::Vector3d p = key_frame.camera_from_map * (line.start + share * along);
      const Eigen::Vector2d noise(random.Gaussian(noise_px), random.Gaussian(noise_px));
      return Eigen::Vector2d(p.head<2>() / p.z() + noise / 800);
    };
    const LineSegment2 segment{see(random.Uniform(0, 0.2)), see(random.Uniform(0.8, 1))};
    if (segment.start.cwiseAbs().maxCoeff() > 0.6 || segment.end.cwiseAbs().maxCoeff() > 0.6) {
      continue;
    }
    seen.normalized.push_back(segment);
    std::vector<std::uint8_t> row = scene.line_rows[i];
    for (int flips = 0; flips < 12; ++flips) {
      row[random.Below(32)] ^= static_cast<std::uint8_t>(1u << random.Below(8));
    }
    seen.descriptors.bytes.insert(seen.descriptors.bytes.end(), row.begin(), row.end());
  }
  return seen;
}

// The largest distance of the found line's ends from the true infinite line.
inline double DistanceFromLine(const LineSegment3& found, const LineSegment3& truth) {
  const Eigen::Vector3d along = (truth.end - truth.start).normalized();
  return std::max(along.cross(found.start - truth.start).norm(),
                  along.cross(found.end - truth.start).norm());
}

}  // namespace maploc::testing
