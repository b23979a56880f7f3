#include "server/ransac/sampler.h"

#include "server/solvers/p3p.h"
#include "server/solvers/up1p1l.h"
#include "server/solvers/up1p2v.h"
#include "server/solvers/up2p.h"
#include "server/solvers/yaw_equation.h"

namespace maploc {
namespace {

constexpr double kMinConditioning = 0.17364817766693033;  // sin 10 degrees
constexpr double kMinImageDistancePx = 10.0;
constexpr double kMinDangerCircle = 0.1;      // of Up1p2vConditioning
constexpr double kMinP3pConditioning = 1e-4;  // two angles of half a degree and more
constexpr int kGateWindow = 64;               // draws between two looks at the share that passes
constexpr double kNoGate = 1.0 / 64;          // below this factor gates are off

// A draw without replacement: `draw` in [0, n - 1) skips `taken`.
std::uint32_t Skip(std::uint32_t draw, std::uint32_t taken) {
  return draw < taken ? draw : draw + 1;
}

}  // namespace

Sampler::Sampler(const PreparedProblem& prepared, Strategy strategy)
    : prepared_(prepared),
      strategy_(strategy),
      draw_vertical_(prepared.vertical_lines.size() >= 2 &&
                     prepared.vertical_lines.size() > prepared.usable_lines.size() &&
                     (strategy == Strategy::k1P1L || strategy == Strategy::kMixed)) {}

std::uint32_t Sampler::LineEntities() const {
  return static_cast<std::uint32_t>(prepared_.usable_lines.size() +
                                    (draw_vertical_ ? prepared_.vertical_lines.size() : 0));
}

bool Sampler::CanDraw() const {
  const std::size_t points = prepared_.points.size();
  switch (strategy_) {
    case Strategy::k1P1L:
      return points >= 1 && LineEntities() >= 1;
    case Strategy::k2P:
      return points >= 2;
    case Strategy::kMixed:
      return points >= 1 && points + LineEntities() >= 2;
    case Strategy::kP3P:
      return points >= 3;
  }
  return false;
}

Hypotheses Sampler::Draw(Random& random) {
  Hypotheses out;
  const std::uint32_t points = static_cast<std::uint32_t>(prepared_.points.size());
  const std::uint32_t first = random.Below(points);
  bool passed = false;
  switch (strategy_) {
    case Strategy::k1P1L:
      passed = DrawPointAndLineEntity(first, random.Below(LineEntities()), random, &out);
      break;
    case Strategy::k2P:
      passed = DrawTwoPoints(first, Skip(random.Below(points - 1), first), &out);
      break;
    case Strategy::kMixed: {
      const std::uint32_t second = random.Below(points - 1 + LineEntities());
      passed = second < points - 1
                   ? DrawTwoPoints(first, Skip(second, first), &out)
                   : DrawPointAndLineEntity(first, second - (points - 1), random, &out);
      break;
    }
    case Strategy::kP3P:
      passed = DrawThreePoints(first, random, &out);
      break;
  }
  CountDraw(passed);
  if (out.sampled_points == 0) out.points[out.sampled_points++] = first;
  return out;
}

void Sampler::CountDraw(bool passed) {
  ++window_draws_;
  window_passed_ += passed ? 1 : 0;
  if (window_draws_ < kGateWindow) return;
  if (2 * window_passed_ < window_draws_) gate_ = gate_ > kNoGate ? gate_ / 2 : 0.0;
  window_draws_ = 0;
  window_passed_ = 0;
}

bool Sampler::DrawTwoPoints(std::uint32_t first, std::uint32_t second, Hypotheses* out) {
  const PreparedPoint& a = prepared_.points[first];
  const PreparedPoint& b = prepared_.points[second];
  const double min_distance = gate_ * kMinImageDistancePx / prepared_.centred.focal_length_px;
  if ((a.ray_in_camera - b.ray_in_camera).squaredNorm() < min_distance * min_distance ||
      Up2pConditioning(a.ray_in_aligned, a.position, b.ray_in_aligned, b.position) <
          gate_ * kMinConditioning) {
    return false;
  }
  out->sampled_points = 2;
  out->points[0] = first;
  out->points[1] = second;
  AlignedPose poses[2];
  AddAligned(poses, SolveUp2p(a.ray_in_aligned, a.position, b.ray_in_aligned, b.position, poses),
             out);
  return true;
}

bool Sampler::DrawPointAndLineEntity(std::uint32_t point, std::uint32_t entity, Random& random,
                                     Hypotheses* out) {
  const std::size_t usable = prepared_.usable_lines.size();
  if (entity < usable) return DrawPointAndLine(point, prepared_.usable_lines[entity], out);
  return DrawPointAndVerticals(point, prepared_.vertical_lines[entity - usable], random, out);
}

bool Sampler::DrawPointAndLine(std::uint32_t point, std::int32_t line, Hypotheses* out) {
  const PreparedPoint& p = prepared_.points[point];
  const PreparedLine& l = prepared_.lines[line];
  // Distance of the image point to the image line, in the plane z = 1: |n . x| / |(nx, ny)|.
  const double distance = gate_ * kMinImageDistancePx / prepared_.centred.focal_length_px *
                          l.plane_normal_in_camera.head<2>().norm();
  if (std::abs(l.plane_normal_in_camera.dot(p.ray_in_camera)) < distance ||
      Up1p1lConditioning(l.plane_normal_in_aligned, l.direction) < gate_ * kMinConditioning) {
    return false;
  }
  AlignedPose poses[2];
  AddAligned(poses,
             SolveUp1p1l(p.ray_in_aligned, p.position, l.plane_normal_in_aligned, l.point,
                         l.direction, poses),
             out);
  return true;
}

bool Sampler::DrawPointAndVerticals(std::uint32_t point, std::int32_t line, Random& random,
                                    Hypotheses* out) {
  const std::int32_t other = prepared_.vertical_lines[random.Below(
      static_cast<std::uint32_t>(prepared_.vertical_lines.size()))];
  if (other == line) return false;
  const PreparedPoint& p = prepared_.points[point];
  const PreparedLine& a = prepared_.lines[line];
  const PreparedLine& b = prepared_.lines[other];
  if (Up1p2vConditioning(p.ray_in_aligned, p.position, a.plane_normal_in_aligned, a.point,
                         b.plane_normal_in_aligned, b.point) < gate_ * kMinDangerCircle) {
    return false;
  }
  AlignedPose poses[2];
  AddAligned(poses,
             SolveUp1p2v(p.ray_in_aligned, p.position, a.plane_normal_in_aligned, a.point,
                         b.plane_normal_in_aligned, b.point, poses),
             out);
  return true;
}

bool Sampler::DrawThreePoints(std::uint32_t first, Random& random, Hypotheses* out) {
  const std::uint32_t points = static_cast<std::uint32_t>(prepared_.points.size());
  const std::uint32_t second = Skip(random.Below(points - 1), first);
  const std::uint32_t third = random.Below(points);
  if (third == first || third == second) return false;
  Eigen::Vector3d rays[3];
  Eigen::Vector3d positions[3];
  const std::uint32_t sample[3] = {first, second, third};
  out->sampled_points = 3;
  for (int i = 0; i < 3; ++i) {
    out->points[i] = sample[i];
    rays[i] = prepared_.points[sample[i]].ray_in_camera;
    positions[i] = prepared_.points[sample[i]].position;
  }
  if (P3pConditioning(rays, positions) < gate_ * kMinP3pConditioning) return false;
  Rigid3 poses[kMaxPosesOfSample];
  out->count = SolveP3p(rays, positions, poses);
  for (int i = 0; i < out->count; ++i) out->camera_from_centred[i] = PoseMatrix(poses[i]);
  return true;
}

void Sampler::AddAligned(const AlignedPose* poses, int count, Hypotheses* out) const {
  const Eigen::Matrix3d& turn = prepared_.camera_from_aligned_matrix;
  for (int i = 0; i < count; ++i) {
    PoseMatrix& pose = out->camera_from_centred[i];
    pose.rotation.noalias() = turn * RotationMatrix(poses[i].yaw);
    pose.translation.noalias() = turn * poses[i].translation;
  }
  out->count = count;
}

}  // namespace maploc
