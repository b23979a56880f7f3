#include "server/ransac/sampler.h"

#include <cmath>

#include "server/solvers/p3p.h"
#include "server/solvers/up1p2v.h"

namespace maploc {
namespace {

constexpr double kMinConditioning = 0.17364817766693033;  // sin 10 degrees
constexpr double kMinImageDistancePx = 10.0;
constexpr double kMinDangerCircle = 0.1;      // of Up1p2vConditioning
constexpr double kMinP3pConditioning = 1e-4;  // two angles of half a degree and more
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
            prepared.has_quality),
      block_(prepared) {}

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

const Hypotheses& Sampler::Draw(Random& random) {
  if (next_ == block_.size()) FillBlock(random);
  return block_.At(next_++);
}

void Sampler::FillBlock(Random& random) {
  block_.Clear();
  next_ = 0;
  passed_ = 0;
  for (int i = 0; i < SampleBlock::kSize; ++i) {
    AddDraw(random);
    pool_.Advance();
  }
  passed_ += block_.Solve(gate_ * kMinConditioning);
  if (2 * passed_ < SampleBlock::kSize) gate_ = gate_ > kNoGate ? gate_ / 2 : 0.0;
}

void Sampler::AddDraw(Random& random) {
  const Pools pools = CurrentPools();
  const std::uint32_t first = random.Below(pools.points);
  switch (strategy_) {
    case Strategy::k1P1L:
      return AddPointAndLineEntity(pools, first, random.Below(pools.lines()), random);
    case Strategy::k2P:
      return AddTwoPoints(first, Skip(random.Below(pools.points - 1), first));
    case Strategy::kMixed:
      return AddMixed(pools, first, random);
    case Strategy::kP3P:
      return AddThreePoints(pools, first, random);
  }
}

void Sampler::AddMixed(const Pools& pools, std::uint32_t first, Random& random) {
  const std::uint32_t others = pools.points - 1;
  const std::uint32_t second = random.Below(others + pools.lines());
  if (second < others) return AddTwoPoints(first, Skip(second, first));
  AddPointAndLineEntity(pools, first, second - others, random);
}

void Sampler::AddTwoPoints(std::uint32_t first, std::uint32_t second) {
  const Sample sample = {
      .point_count = 2,
      .points = {prepared_.drawn_points[first], prepared_.drawn_points[second], 0}};
  const double least = gate_ * kMinImageDistancePx / prepared_.centred.focal_length_px;
  if (ImageDistance2(prepared_.points[sample.points[0]], prepared_.points[sample.points[1]]) <
      least * least) {
    return block_.AddRejected();
  }
  block_.AddTwoPoints(sample);
}

void Sampler::AddPointAndLineEntity(const Pools& pools, std::uint32_t point, std::uint32_t entity,
                                    Random& random) {
  if (entity < pools.usable_lines) return AddPointAndLine(point, entity);
  const std::uint32_t line = entity - pools.usable_lines;
  AddPointAndVerticals(point, line, random.Below(pools.vertical_lines));
}

void Sampler::AddPointAndLine(std::uint32_t point, std::uint32_t line) {
  const Sample sample = {.point_count = 1,
                         .line_count = 1,
                         .points = {prepared_.drawn_points[point], 0, 0},
                         .lines = {prepared_.usable_lines[line], 0}};
  const double least = gate_ * kMinImageDistancePx / prepared_.centred.focal_length_px;
  if (IsNearer(prepared_.points[sample.points[0]], prepared_.lines[sample.lines[0]], least)) {
    return block_.AddRejected();
  }
  block_.AddPointAndLine(sample);
}

void Sampler::AddPointAndVerticals(std::uint32_t point, std::uint32_t line, std::uint32_t other) {
  // A rejected draw is no iteration, so that the draws that count are of two different lines, as
  // the stop rule takes them to be (DrawProbability).
  if (other == line) return block_.AddRejected();
  Hypotheses out;
  out.sample = {.point_count = 1,
                .line_count = 2,
                .points = {prepared_.drawn_points[point], 0, 0},
                .lines = {prepared_.vertical_lines[line], prepared_.vertical_lines[other]}};
  const PreparedPoint& p = prepared_.points[out.sample.points[0]];
  const PreparedLine& a = prepared_.lines[out.sample.lines[0]];
  const PreparedLine& b = prepared_.lines[out.sample.lines[1]];
  if (Up1p2vConditioning(p.ray_in_aligned, p.position, a.plane_normal_in_aligned, a.point,
                         b.plane_normal_in_aligned, b.point) < gate_ * kMinDangerCircle) {
    return block_.AddRejected();
  }
  ++passed_;
  AlignedPose poses[2];
  out.count = SolveUp1p2v(p.ray_in_aligned, p.position, a.plane_normal_in_aligned, a.point,
                          b.plane_normal_in_aligned, b.point, poses);
  for (int i = 0; i < out.count; ++i) {
    out.camera_from_centred[i] = CameraFromCentred(prepared_, poses[i]);
  }
  block_.AddSolved(out);
}

void Sampler::AddThreePoints(const Pools& pools, std::uint32_t first, Random& random) {
  const std::uint32_t second = Skip(random.Below(pools.points - 1), first);
  const std::uint32_t third = random.Below(pools.points);
  if (third == first || third == second) return block_.AddRejected();
  Hypotheses out;
  Eigen::Vector3d rays[3];
  Eigen::Vector3d positions[3];
  const std::uint32_t drawn[3] = {first, second, third};
  out.sample.point_count = 3;
  for (int i = 0; i < 3; ++i) {
    out.sample.points[i] = prepared_.drawn_points[drawn[i]];
    rays[i] = prepared_.points[out.sample.points[i]].ray_in_camera;
    positions[i] = prepared_.points[out.sample.points[i]].position;
  }
  if (P3pConditioning(rays, positions) < gate_ * kMinP3pConditioning) return block_.AddRejected();
  ++passed_;
  Rigid3 poses[kMaxPosesOfSample];
  out.count = SolveP3p(rays, positions, poses);
  for (int i = 0; i < out.count; ++i) out.camera_from_centred[i] = PoseMatrix(poses[i]);
  block_.AddSolved(out);
}

}  // namespace maploc
