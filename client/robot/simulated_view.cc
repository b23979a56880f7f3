#include "client/robot/simulated_view.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace maploc {
namespace {

constexpr double kMinRangeM = 1.0;
constexpr double kMaxRangeM = 20.0;
constexpr double kNearPlaneM = 0.5;
constexpr double kMinLinePx = 20.0;       // as the line detector has it
constexpr double kMaxShareCut = 0.2;      // of a line's length, at each end
constexpr double kOwnStretchShare = 0.7;  // of look-alikes; the others are from anywhere
constexpr double kCrownHeart = 0.5;  // of a crown's radius, within which it hides what is behind

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

class Looker {
 public:
  Looker(const World& world, const Camera& camera, const Rigid3& camera_from_world,
         const Appearance& appearance, const SightOptions& options, Random& random)
      : world_(world),
        camera_(camera),
        camera_from_world_(camera_from_world),
        centre_(camera_from_world.Inverse().translation),
        appearance_(appearance),
        options_(options),
        random_(random) {
    sight_.points.descriptors.kind = {"orb", 32, DescriptorMetric::kHamming};
    sight_.lines.descriptors.kind = {"lbd", 32, DescriptorMetric::kHamming};
  }

  Sight Look() {
    for (std::size_t i = 0; i < world_.points.size(); ++i) LookAtPoint(static_cast<int>(i));
    for (std::size_t i = 0; i < world_.lines.size(); ++i) LookAtLine(static_cast<int>(i));
    AddClutter();
    return std::move(sight_);
  }

 private:
  Change ChangeOf(LandmarkKind kind) const { return appearance_[static_cast<int>(kind)]; }

  void LookAtPoint(int index) {
    const WorldPoint& point = world_.points[index];
    const Change change = ChangeOf(point.kind);
    if (!IsVisible(point.position, point.wall)) return;
    const auto pixel = camera_.Project(camera_from_world_ * point.position);
    if (!pixel || !IsInImage(*pixel) || random_.Uniform() < change.unseen) return;
    AddPoint(Noisy(*pixel), Seen(world_.points, index, change), index);
  }

  void LookAtLine(int index) {
    const WorldLine& line = world_.lines[index];
    const Change change = ChangeOf(line.kind);
    const Eigen::Vector3d middle = (line.segment.start + line.segment.end) / 2.0;
    if (!IsVisible(middle, line.wall)) return;
    const auto seen = Project(line.segment);
    if (!seen || random_.Uniform() < change.unseen) return;
    AddLine(*seen, Seen(world_.lines, index, change), index);
  }

  // Near enough, on the front of its wall, and nothing in between.
  bool IsVisible(const Eigen::Vector3d& position, int own_wall) const {
    const double range_m = (position - centre_).norm();
    if (range_m > kMaxRangeM || range_m < kMinRangeM) return false;
    const Eigen::Vector2d from = centre_.head<2>();
    const Eigen::Vector2d to = position.head<2>();
    if (own_wall >= 0 && world_.walls[own_wall].normal.dot(from - to) <= 0.0) return false;
    for (std::size_t i = 0; i < world_.walls.size(); ++i) {
      if (static_cast<int>(i) != own_wall && Hides(world_.walls[i], from, to)) return false;
    }
    return std::ranges::none_of(world_.trees,
                                [&](const Tree& tree) { return Hides(tree, from, to); });
  }

  // In plan: the lane's robots are lower than any roof.
  static bool Hides(const Wall& wall, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d sight = to - from;
    const Eigen::Vector2d front = wall.end - wall.start;
    const double parallel = Cross(sight, front);
    // Seen edge-on a front hides nothing.
    if (std::abs(parallel) < 1e-12) return false;
    const double along_sight = Cross(wall.start - from, front) / parallel;
    const double along_front = Cross(wall.start - from, sight) / parallel;
    return along_sight > 0.0 && along_sight < 1.0 && along_front > 0.0 && along_front < 1.0;
  }
  static bool Hides(const Tree& tree, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d sight = to - from;
    // 1.5 radii and 0.5 m reach the middle of the longest branch (simulated_world.cc, AddTree).
    if ((to - tree.position).norm() <= 1.5 * tree.crown_radius_m + 0.5) return false;  // its own
    const double along =
        std::clamp((tree.position - from).dot(sight) / sight.squaredNorm(), 0.0, 1.0);
    return (from + along * sight - tree.position).norm() < kCrownHeart * tree.crown_radius_m;
  }

  // The part of a segment that the image shows; nullopt when that is too short to be detected.
  std::optional<LineSegment2> Project(const LineSegment3& segment) {
    Eigen::Vector3d a = camera_from_world_ * segment.start;
    Eigen::Vector3d b = camera_from_world_ * segment.end;
    if (a.z() < kNearPlaneM || b.z() < kNearPlaneM) return std::nullopt;
    // A detector rarely finds an edge to its very ends.
    const Eigen::Vector3d whole = b - a;
    a += whole * random_.Uniform(0.0, kMaxShareCut);
    b -= whole * random_.Uniform(0.0, kMaxShareCut);
    const auto visible = Clip({*camera_.Project(a), *camera_.Project(b)});
    if (!visible || (visible->end - visible->start).norm() < kMinLinePx) return std::nullopt;
    return LineSegment2{Noisy(visible->start), Noisy(visible->end)};
  }

  // The part inside the image (Liang and Barsky).
  std::optional<LineSegment2> Clip(const LineSegment2& line) const {
    const Eigen::Vector2d whole = line.end - line.start;
    const Eigen::Vector2d last(camera_.width_px() - 1.0, camera_.height_px() - 1.0);
    double from = 0.0;
    double to = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
      if (whole[axis] == 0.0) {
        if (line.start[axis] < 0.0 || line.start[axis] > last[axis]) return std::nullopt;
        continue;
      }
      const double at_first = -line.start[axis] / whole[axis];
      const double at_last = (last[axis] - line.start[axis]) / whole[axis];
      from = std::max(from, std::min(at_first, at_last));
      to = std::min(to, std::max(at_first, at_last));
    }
    if (from >= to) return std::nullopt;
    return LineSegment2{line.start + from * whole, line.start + to * whole};
  }

  bool IsInImage(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= camera_.width_px() - 1.0 &&
           pixel.y() <= camera_.height_px() - 1.0;
  }
  Eigen::Vector2d Noisy(const Eigen::Vector2d& pixel) {
    return pixel + Eigen::Vector2d(random_.Gaussian(options_.noise_px),
                                   random_.Gaussian(options_.noise_px));
  }
  Eigen::Vector2d Anywhere() {
    return {random_.Uniform(0.0, camera_.width_px() - 1.0),
            random_.Uniform(0.0, camera_.height_px() - 1.0)};
  }

  // The descriptor that the season shows of a landmark.
  template <typename Landmark>
  BinaryDescriptor Seen(const std::vector<Landmark>& landmarks, int index, const Change& change) {
    const Landmark& landmark = landmarks[index];
    const bool disguised = options_.look_alikes && random_.Uniform() < change.look_alike;
    const Landmark& shown = disguised ? LookAlike(landmarks, landmark) : landmark;
    return Flipped(shown.descriptor, change.flip, random_);
  }

  // Another landmark of the same kind, mostly of the same stretch.
  template <typename Landmark>
  const Landmark& LookAlike(const std::vector<Landmark>& landmarks, const Landmark& landmark) {
    const bool near_by = random_.Uniform() < kOwnStretchShare;
    // A landmark may be the only one of its kind along its stretch. It keeps its own look then.
    constexpr int kTries = 200;
    for (int i = 0; i < kTries; ++i) {
      const Landmark& other =
          landmarks[random_.Below(static_cast<std::uint32_t>(landmarks.size()))];
      if (other.kind == landmark.kind && (!near_by || other.stretch == landmark.stretch))
        return other;
    }
    return landmark;
  }

  void AddClutter() {
    for (int i = 0; i < options_.clutter_points; ++i) {
      AddPoint(Anywhere(), RandomDescriptor(random_), -1);
    }
    for (int i = 0; i < options_.clutter_lines; ++i) {
      const Eigen::Vector2d start = Anywhere();
      const double angle = random_.Uniform(0.0, 3.14159);
      const Eigen::Vector2d end =
          start + random_.Uniform(20.0, 80.0) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      AddLine({start, end}, RandomDescriptor(random_), -1);
    }
  }

  void AddPoint(const Eigen::Vector2d& pixel, const BinaryDescriptor& descriptor, int landmark) {
    sight_.points.keypoints_px.push_back(pixel.cast<float>());
    Append(descriptor, sight_.points.descriptors);
    sight_.point_landmarks.push_back(landmark);
  }
  void AddLine(const LineSegment2& line, const BinaryDescriptor& descriptor, int landmark) {
    sight_.lines.starts_px.push_back(line.start.cast<float>());
    sight_.lines.ends_px.push_back(line.end.cast<float>());
    Append(descriptor, sight_.lines.descriptors);
    sight_.line_landmarks.push_back(landmark);
  }
  static void Append(const BinaryDescriptor& descriptor, Descriptors& descriptors) {
    descriptors.bytes.insert(descriptors.bytes.end(), descriptor.begin(), descriptor.end());
  }

  const World& world_;
  const Camera& camera_;
  const Rigid3& camera_from_world_;
  const Eigen::Vector3d centre_;
  const Appearance& appearance_;
  const SightOptions& options_;
  Random& random_;
  Sight sight_;
};

}  // namespace

Camera SimulatedCamera() {
  return *Camera::Create(CameraModel::kPinhole, 640, 480, {380.0, 380.0, 319.5, 239.5});
}

Sight Look(const World& world, const Camera& camera, const Rigid3& camera_from_world,
           const Appearance& appearance, const SightOptions& options, Random& random) {
  return Looker(world, camera, camera_from_world, appearance, options, random).Look();
}

}  // namespace maploc
