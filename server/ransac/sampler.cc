#include "server/ransac/sampler.h"

#include <cmath>

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

// In the plane z = 1; where there is none, of rays (chords, for small ones) times their scale.
double ImageDistance2(const PreparedPoint& a, const PreparedPoint& b) {
  const double rays2 = (a.ray_in_camera - b.ray_in_camera).squaredNorm();
  return a.scale > 0 ? a.scale * b.scale * rays2 : rays2;
}

// Whether the image point lies nearer to the image line than `distance`: |n . x| / |(nx, ny)|.
bool IsNearer(const PreparedPoint& point, const PreparedLine& line, double distance) {
  const Eigen::Vector3d& n = line.plane_normal_in_camera;
  const double off = std::abs(n.dot(point.ray_in_camera));
  return point.scale > 0 ? point.scale * off < distance : off < distance * n.head<2>().norm();
}

}  // namespace

Sampler::Sampler(const PreparedProblem& prepared, Strategy strategy)
    : prepared_(prepared),
      strategy_(strategy),
      draw_vertical_(DrawsVerticalLines(strategy, prepared.usable_lines.size(),
                                        prepared.vertical_lines.size())),
      pool_(static_cast<std::uint32_t>(prepared.points.size() + prepared.lines.size()),
            prepared.has_quality) {}

Sampler::Pools Sampler::CurrentPools() const {
  const auto size_of = [&](const std::vector<std::uint32_t>& order) {
    return pool_.SizeOf(static_cast<std::uint32_t>(order.size()));
  };
  return {.points = size_of(prepared_.drawn_points),
          .usable_lines = size_of(prepared_.usable_lines),
          .vertical_lines = draw_vertical_ ? size_of(prepared_.vertical_lines) : 0};
}

bool Sampler::CanDraw() const {
  const Pools pools = CurrentPools();
  switch (strategy_) {
    case Strategy::k1P1L:
      return pools.points >= 1 && pools.lines() >= 1;
    case Strategy::k2P:
      return pools.points >= 2;
    case Strategy::kMixed:
      return pools.points >= 1 && pools.points + pools.lines() >= 2;
    case Strategy::kP3P:
      return pools.points >= 3;
  }
  return false;
}

Hypotheses Sampler::Draw(Random& random) {
  Hypotheses out;
  const Pools pools = CurrentPools();
  const std::uint32_t first = random.Below(pools.points);
  bool passed = false;
  switch (strategy_) {
    case Strategy::k1P1L:
      passed = DrawPointAndLineEntity(pools, first, random.Below(pools.lines()), random, &out);
      break;
    case Strategy::k2P:
      passed = DrawTwoPoints(first, Skip(random.Below(pools.points - 1), first), &out);
      break;
    case Strategy::kMixed:
      passed = DrawMixed(pools, first, random, &out);
      break;
    case Strategy::kP3P:
      passed = DrawThreePoints(pools, first, random, &out);
      break;
  }
  pool_.Advance();
  CountDraw(passed);
  return out;
}

bool Sampler::DrawMixed(const Pools& pools, std::uint32_t first, Random& random, Hypotheses* out) {
  const std::uint32_t others = pools.points - 1;
  const std::uint32_t second = random.Below(others + pools.lines());
  return second < others ? DrawTwoPoints(first, Skip(second, first), out)
                         : DrawPointAndLineEntity(pools, first, second - others, random, out);
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
  out->sampled_points = 2;
  out->points[0] = prepared_.drawn_points[first];
  out->points[1] = prepared_.drawn_points[second];
  const PreparedPoint& a = prepared_.points[out->points[0]];
  const PreparedPoint& b = prepared_.points[out->points[1]];
  const double min_distance = gate_ * kMinImageDistancePx / prepared_.centred.focal_length_px;
  if (ImageDistance2(a, b) < min_distance * min_distance ||
      !IsYawConditioned(a.ray_in_aligned.cross(b.ray_in_aligned), b.position - a.position,
                        gate_ * kMinConditioning)) {
    return false;
  }
  AlignedPose poses[2];
  AddAligned(poses, SolveUp2p(a.ray_in_aligned, a.position, b.ray_in_aligned, b.position, poses),
             out);
  return true;
}

bool Sampler::DrawPointAndLineEntity(const Pools& pools, std::uint32_t point, std::uint32_t entity,
                                     Random& random, Hypotheses* out) {
  if (entity < pools.usable_lines) return DrawPointAndLine(point, entity, out);
  const std::uint32_t line = entity - pools.usable_lines;
  return DrawPointAndVerticals(point, line, random.Below(pools.vertical_lines), out);
}

bool Sampler::DrawPointAndLine(std::uint32_t point, std::uint32_t line, Hypotheses* out) {
  out->sampled_points = 1;
  out->sampled_lines = 1;
  out->points[0] = prepared_.drawn_points[point];
  out->lines[0] = prepared_.usable_lines[line];
  const PreparedPoint& p = prepared_.points[out->points[0]];
  const PreparedLine& l = prepared_.lines[out->lines[0]];
  const double distance = gate_ * kMinImageDistancePx / prepared_.centred.focal_length_px;
  if (IsNearer(p, l, distance) ||
      !IsYawConditioned(l.plane_normal_in_aligned, l.direction, gate_ * kMinConditioning)) {
    return false;
  }
  AlignedPose poses[2];
  AddAligned(poses,
             SolveUp1p1l(p.ray_in_aligned, p.position, l.plane_normal_in_aligned, l.point,
                         l.direction, poses),
             out);
  return true;
}

bool Sampler::DrawPointAndVerticals(std::uint32_t point, std::uint32_t line, std::uint32_t other,
                                    Hypotheses* out) {
  out->sampled_points = 1;
  out->points[0] = prepared_.drawn_points[point];
  if (other == line) return false;
  out->sampled_lines = 2;
  out->lines[0] = prepared_.vertical_lines[line];
  out->lines[1] = prepared_.vertical_lines[other];
  const PreparedPoint& p = prepared_.points[out->points[0]];
  const PreparedLine& a = prepared_.lines[out->lines[0]];
  const PreparedLine& b = prepared_.lines[out->lines[1]];
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

bool Sampler::DrawThreePoints(const Pools& pools, std::uint32_t first, Random& random,
                              Hypotheses* out) {
  const std::uint32_t second = Skip(random.Below(pools.points - 1), first);
  const std::uint32_t third = random.Below(pools.points);
  if (third == first || third == second) return false;
  Eigen::Vector3d rays[3];
  Eigen::Vector3d positions[3];
  const std::uint32_t sample[3] = {first, second, third};
  out->sampled_points = 3;
  for (int i = 0; i < 3; ++i) {
    out->points[i] = prepared_.drawn_points[sample[i]];
    rays[i] = prepared_.points[out->points[i]].ray_in_camera;
    positions[i] = prepared_.points[out->points[i]].position;
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
