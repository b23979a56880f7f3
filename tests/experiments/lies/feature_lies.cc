// Mirrored pictures, features of one patch, few features.
#include <algorithm>
#include <cmath>

#include "mapstore/features/features.h"
#include "tests/experiments/lies/lie.h"

namespace maploc::lies {
namespace {

Status DoesNotApply(const char* why) { return FailedPrecondition("DOES_NOT_APPLY", why); }

Result<Query> MirroredKeypoints(const HonestQuery& honest, int, Random&) {
  Query query = honest.query;
  View& view = query.views[0];
  const float last = static_cast<float>(view.camera.width_px() - 1);
  for (auto* pixels : {&view.points.keypoints_px, &view.lines.starts_px, &view.lines.ends_px}) {
    for (Eigen::Vector2f& pixel : *pixels) pixel.x() = last - pixel.x();
  }
  return query;
}

GrayImage Mirrored(GrayImage image) {
  for (int y = 0; y < image.height_px; ++y) {
    const auto row = image.pixels.begin() + static_cast<std::ptrdiff_t>(y) * image.width_px;
    std::reverse(row, row + image.width_px);
  }
  return image;
}

Result<Query> MirroredPhoto(const HonestQuery& honest, int, Random&) {
  if (honest.photo.empty()) return DoesNotApply("there is no photo");
  Query query = honest.query;
  View& view = query.views[0];
  MAPLOC_ASSIGN_OR_RETURN(GrayImage image, LoadGrayImage(honest.photo));
  image = Mirrored(std::move(image));
  MAPLOC_ASSIGN_OR_RETURN(view.points, DetectPoints(image, view.points.descriptors.kind));
  MAPLOC_ASSIGN_OR_RETURN(view.lines, DetectLines(image));
  return query;
}

// A window of a tenth of the image's area, of its proportions.
struct Window {
  Eigen::Vector2f from;
  Eigen::Vector2f to;

  Window(const Camera& camera, Random& random) {
    const double share = std::sqrt(0.1);
    const Eigen::Vector2d size(camera.width_px(), camera.height_px());
    const Eigen::Vector2d corner(random.Uniform() * (1 - share) * size.x(),
                                 random.Uniform() * (1 - share) * size.y());
    from = corner.cast<float>();
    to = (corner + share * size).cast<float>();
  }
  bool Holds(const Eigen::Vector2f& pixel) const {
    return (pixel.array() >= from.array()).all() && (pixel.array() <= to.array()).all();
  }
};

PointFeatures PointsIn(const Window& window, const PointFeatures& points) {
  PointFeatures inside{{}, {points.descriptors.kind, {}}};
  for (std::size_t i = 0; i < points.keypoints_px.size(); ++i) {
    if (!window.Holds(points.keypoints_px[i])) continue;
    const auto row = points.descriptors.row(static_cast<int>(i));
    inside.keypoints_px.push_back(points.keypoints_px[i]);
    inside.descriptors.bytes.insert(inside.descriptors.bytes.end(), row.begin(), row.end());
  }
  return inside;
}

LineFeatures LinesIn(const Window& window, const LineFeatures& lines) {
  LineFeatures inside{{}, {}, {lines.descriptors.kind, {}}};
  for (int i = 0; i < lines.size(); ++i) {
    if (!window.Holds(lines.starts_px[i]) || !window.Holds(lines.ends_px[i])) continue;
    const auto row = lines.descriptors.row(i);
    inside.starts_px.push_back(lines.starts_px[i]);
    inside.ends_px.push_back(lines.ends_px[i]);
    inside.descriptors.bytes.insert(inside.descriptors.bytes.end(), row.begin(), row.end());
  }
  return inside;
}

Result<Query> OnePatch(const HonestQuery& honest, int, Random& random) {
  Query query = honest.query;
  View& view = query.views[0];
  const Window window(view.camera, random);
  view.points = PointsIn(window, view.points);
  view.lines = LinesIn(window, view.lines);
  return query;
}

Lie Few(int count, bool with_lines) {
  return {"few", std::to_string(count) + (with_lines ? " keypoints and lines" : " keypoints alone"),
          true, [=](const HonestQuery& honest, int, Random& random) -> Result<Query> {
            Query query = honest.query;
            KeepSomePoints(count, random, query.views[0].points);
            if (!with_lines) query.views[0].lines = {};
            return query;
          }};
}

}  // namespace

std::vector<Lie> FeatureLies() {
  std::vector<Lie> lies = {{"mirror", "keypoints mirrored", false, MirroredKeypoints},
                           {"mirror", "photo mirrored", false, MirroredPhoto},
                           {"patch", "one patch of 10%", true, OnePatch}};
  for (const int count : {3000, 2000, 1500, 1000, 60, 30}) {
    lies.push_back(Few(count, false));
    lies.push_back(Few(count, true));
  }
  return lies;
}

}  // namespace maploc::lies
