// A small world for tests of the whole pipeline: a street along x, cut into segments, with points
// and lines on both of its fronts, each with a descriptor of its own.
//
//      y = 5   ====================================   front
//                 o->  o->  o->  (the mapping path, z = 1.5)
//      y = -5  ====================================   front
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/model/map.h"
#include "mapstore/model/query.h"

namespace maploc::testing {

struct DrawnWorldOptions {
  int segments = 3;
  double segment_length_m = 12.0;  // a segment's landmarks reach half as far into the next
  int points_a_metre = 12;
  int lines_a_metre = 2;
  double vertical_line_share = 0.5;
};

struct QueryNoise {
  double pixel_sigma = 0.7;
  double gravity_sigma_rad = 0.01;  // that is sent, and drawn from
  double gravity_error_rad = 0.0;   // a fault on top, about the camera's axis
  double outlier_share = 0.3;       // features described as something elsewhere in the view
  int flipped_bits = 12;            // of 256, a descriptor
  int max_points = 150;
  int max_lines = 30;
};

class DrawnWorld {
 public:
  explicit DrawnWorld(Random random, DrawnWorldOptions options = {})
      : options_(options), random_(random) {
    for (int s = 0; s < options_.segments; ++s) DrawLandmarks(s);
    for (int s = 0; s < options_.segments; ++s) segments_.push_back(CutSegment(s));
    info_.key = {"street", 1};
    info_.metric = true;
    info_.point_descriptor = PointKind();
    info_.line_descriptor = LineKind();
  }

  static DescriptorKind PointKind() { return {"orb", 32, DescriptorMetric::kHamming}; }
  static DescriptorKind LineKind() { return {"lbd", 32, DescriptorMetric::kHamming}; }
  const MapInfo& info() const { return info_; }
  const std::vector<std::shared_ptr<const Segment>>& segments() const { return segments_; }

  // A camera on the path at `x`, its axis turned by `yaw_rad` from +x and pitched a little.
  static Rigid3 CameraFromMapAt(double x, double yaw_rad, double pitch_rad = 0.1) {
    Eigen::Matrix3d camera_from_ahead;  // ahead: x forward, y left, z up
    camera_from_ahead << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    const Eigen::Quaterniond ahead_from_map(Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
                                            Eigen::AngleAxisd(-yaw_rad, Eigen::Vector3d::UnitZ()));
    const Eigen::Quaterniond rotation = Eigen::Quaterniond(camera_from_ahead) * ahead_from_map;
    return {rotation, -(rotation * Eigen::Vector3d(x, 0.3, 1.5))};
  }

  // What a camera there sees; `camera_from_body` is sent along, and gravity in the body.
  Query See(const Rigid3& camera_from_map, const QueryNoise& noise, Random& random,
            const Rigid3& camera_from_body = {}) const {
    Query query;
    query.map = info_.key.name;
    View view{DrawnCamera(), camera_from_body, {}, {}};
    view.points.descriptors.kind = PointKind();
    view.lines.descriptors.kind = LineKind();
    SeePoints(camera_from_map, noise, random, view);
    SeeLines(camera_from_map, noise, random, view);
    query.gravity = MeasureGravity(camera_from_map, noise, random, camera_from_body);
    query.views.push_back(std::move(view));
    return query;
  }

  static Camera DrawnCamera() {
    return Camera::Create(CameraModel::kRadial, 800, 600, {500, 400, 300, -0.1, 0.02}).value();
  }

 private:
  using Row = std::vector<std::uint8_t>;

  struct Landmarks {
    std::vector<Eigen::Vector3d> points;
    std::vector<LineSegment3> lines;
    std::vector<Row> point_rows;
    std::vector<Row> line_rows;
  };

  static Row RandomRow(Random& random) {
    Row row(32);
    for (std::uint8_t& byte : row) byte = static_cast<std::uint8_t>(random.Below(256));
    return row;
  }

  Eigen::Vector3d OnFront(double x) {
    const double side = random_.Below(2) == 0 ? 5.0 : -5.0;
    return {x, side + random_.Uniform(-0.5, 0.5), random_.Uniform(0.0, 5.0)};
  }

  void DrawLandmarks(int s) {
    const double begin = s * options_.segment_length_m;
    const double end = begin + options_.segment_length_m;
    const auto count = [&](int a_metre) {
      return static_cast<int>(a_metre * options_.segment_length_m);
    };
    for (int i = 0; i < count(options_.points_a_metre); ++i) {
      all_.points.push_back(OnFront(random_.Uniform(begin, end)));
      all_.point_rows.push_back(RandomRow(random_));
    }
    for (int i = 0; i < count(options_.lines_a_metre); ++i) {
      const Eigen::Vector3d start = OnFront(random_.Uniform(begin, end));
      const bool vertical = random_.Uniform() < options_.vertical_line_share;
      const Eigen::Vector3d along = vertical ? Eigen::Vector3d(0, 0, 1.2)
                                             : Eigen::Vector3d(1.2, 0, random_.Uniform(-0.2, 0.2));
      all_.lines.push_back({start, start + along});
      all_.line_rows.push_back(RandomRow(random_));
    }
  }

  std::shared_ptr<const Segment> CutSegment(int s) const {
    const double begin = (s - 0.5) * options_.segment_length_m;
    const double end = (s + 1.5) * options_.segment_length_m;
    const auto inside = [&](const Eigen::Vector3d& p) { return p.x() >= begin && p.x() <= end; };
    auto segment = std::make_shared<Segment>();
    segment->map = {"street", 1};
    segment->id = s;
    for (double x = 0.0; x <= options_.segment_length_m; x += 1.0) {
      segment->path_in_map.emplace_back(s * options_.segment_length_m + x, 0.0, 1.5);
    }
    segment->points.descriptors.kind = PointKind();
    segment->lines.descriptors.kind = LineKind();
    for (std::size_t i = 0; i < all_.points.size(); ++i) {
      if (!inside(all_.points[i])) continue;
      segment->points.positions_in_map.push_back(all_.points[i]);
      Add(i, all_.point_rows[i], segment->points);
    }
    for (std::size_t i = 0; i < all_.lines.size(); ++i) {
      if (!inside(all_.lines[i].start)) continue;
      segment->lines.segments_in_map.push_back(all_.lines[i]);
      Add(i, all_.line_rows[i], segment->lines);
    }
    return segment;
  }

  template <class L>
  static void Add(std::size_t id, const Row& row, L& landmarks) {
    landmarks.ids.push_back(static_cast<LandmarkId>(id));
    landmarks.descriptors.bytes.insert(landmarks.descriptors.bytes.end(), row.begin(), row.end());
    landmarks.descriptor_landmark.push_back(landmarks.size() - 1);
  }

  static std::optional<Eigen::Vector2f> Pixel(const Rigid3& camera_from_map,
                                              const Eigen::Vector3d& point, double sigma,
                                              Random& random) {
    const Camera camera = DrawnCamera();
    const Eigen::Vector3d in_camera = camera_from_map * point;
    if (in_camera.z() < 0.5) return std::nullopt;
    const std::optional<Eigen::Vector2d> pixel = camera.Project(in_camera);
    if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > 799 || pixel->y() > 599) {
      return std::nullopt;
    }
    return Eigen::Vector2f(static_cast<float>(pixel->x() + random.Gaussian(sigma)),
                           static_cast<float>(pixel->y() + random.Gaussian(sigma)));
  }

  static void Describe(Row row, int flipped_bits, Random& random, Descriptors& descriptors) {
    for (int i = 0; i < flipped_bits; ++i) row[random.Below(32)] ^= 1 << random.Below(8);
    descriptors.bytes.insert(descriptors.bytes.end(), row.begin(), row.end());
  }

  // An outlier stands at a random pixel and looks like the landmark.
  void SeePoints(const Rigid3& camera_from_map, const QueryNoise& noise, Random& random,
                 View& view) const {
    for (std::size_t i = 0; i < all_.points.size(); ++i) {
      auto pixel = Pixel(camera_from_map, all_.points[i], noise.pixel_sigma, random);
      if (!pixel || static_cast<int>(view.points.keypoints_px.size()) >= noise.max_points) continue;
      if (random.Uniform() < noise.outlier_share) pixel = RandomPixel(random);
      view.points.keypoints_px.push_back(*pixel);
      Describe(all_.point_rows[i], noise.flipped_bits, random, view.points.descriptors);
    }
  }

  void SeeLines(const Rigid3& camera_from_map, const QueryNoise& noise, Random& random,
                View& view) const {
    for (std::size_t i = 0; i < all_.lines.size(); ++i) {
      auto start = Pixel(camera_from_map, all_.lines[i].start, noise.pixel_sigma, random);
      auto end = Pixel(camera_from_map, all_.lines[i].end, noise.pixel_sigma, random);
      if (!start || !end || view.lines.size() >= noise.max_lines) continue;
      if (random.Uniform() < noise.outlier_share) start = RandomPixel(random);
      view.lines.starts_px.push_back(*start);
      view.lines.ends_px.push_back(*end);
      Describe(all_.line_rows[i], noise.flipped_bits, random, view.lines.descriptors);
    }
  }

  static Eigen::Vector2f RandomPixel(Random& random) {
    return {static_cast<float>(random.Uniform(0, 799)), static_cast<float>(random.Uniform(0, 599))};
  }

  static Gravity MeasureGravity(const Rigid3& camera_from_map, const QueryNoise& noise,
                                Random& random, const Rigid3& camera_from_body) {
    const Eigen::Vector3d in_camera = GravityInCamera(camera_from_map.rotation);
    const Eigen::Vector3d turn(random.Gaussian(noise.gravity_sigma_rad),
                               random.Gaussian(noise.gravity_sigma_rad),
                               random.Gaussian(noise.gravity_sigma_rad));
    const Eigen::Vector3d noisy =
        Eigen::AngleAxisd(noise.gravity_error_rad, Eigen::Vector3d::UnitZ()) *
        (in_camera + turn.cross(in_camera)).normalized();
    return {camera_from_body.rotation.conjugate() * noisy, noise.gravity_sigma_rad};
  }

  DrawnWorldOptions options_;
  Random random_;
  Landmarks all_;
  std::vector<std::shared_ptr<const Segment>> segments_;
  MapInfo info_;
};

}  // namespace maploc::testing
