// The batched kernels against the scalar ones, on every target this processor has.
#include "server/solvers/batch.h"

#include <deque>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "tests/support/seed.h"
#include "tests/unit/server/solvers/recovery.h"
#include "tests/unit/server/solvers/with_gravity.h"

namespace maploc::testing {
namespace {

// A sample of either kernel, aligned: ray and point; second ray and point; or the line.
struct Sample {
  Eigen::Vector3d ray1, point1, ray2, point2, normal, direction;
};

// Every fourth at an exact quarter turn, every fifth a level pair, and some outliers among them, of
// which one or both solutions do not exist.
Sample MakeSample(int i, Random& random) {
  const Yaw quarters[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  const double angle = random.Uniform(-std::numbers::pi, std::numbers::pi);
  const Yaw turned = {std::cos(angle), -std::sin(angle)};
  const Yaw map_from_aligned = i % 4 == 0 ? quarters[i / 4 % 4] : turned;
  const Eigen::Vector3d shift = 3.0 * RandomDirection(random);
  Sample s;
  s.ray1 = random.Uniform(1, 10) * RandomDirection(random);
  s.ray2 = random.Uniform(1, 10) * RandomDirection(random);
  if (i % 5 == 0) s.ray2.z() = s.ray1.z();
  s.point1 = TurnByYaw(map_from_aligned, s.ray1) + shift;
  s.point2 = TurnByYaw(map_from_aligned, s.ray2) + shift;
  if (i % 5 == 0) s.point2.z() = s.point1.z();
  if (i % 3 == 0) s.point2 += 5.0 * RandomDirection(random);
  const Eigen::Vector3d end = random.Uniform(1, 10) * RandomDirection(random);
  s.normal = s.ray2.cross(end);
  s.direction = TurnByYaw(map_from_aligned, end) + shift - s.point2;
  return s;
}

class Batch {
 public:
  explicit Batch(const std::vector<Sample>& samples) : samples_(samples) {}

  VectorArrays In(Eigen::Vector3d Sample::*member) {
    const double* axes[3];
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double>& values = values_.emplace_back();
      for (const Sample& sample : samples_) values.push_back((sample.*member)[axis]);
      axes[axis] = values.data();
    }
    return {axes[0], axes[1], axes[2]};
  }
  // One number more than there are samples, to see that it is left alone.
  AlignedPoseArrays Out() {
    double* at[5];
    for (double*& array : at) {
      array = values_.emplace_back(samples_.size() + 1, kUntouched).data();
    }
    return {at[0], at[1], at[2], at[3], at[4]};
  }

  static constexpr double kUntouched = 12345;

 private:
  const std::vector<Sample>& samples_;
  std::deque<std::vector<double>> values_;
};

// Largest difference of any number of the pose; infinite when just one of them exists.
double Difference(const AlignedPoseArrays& batch, std::size_t i, bool exists,
                  const AlignedPose& scalar) {
  if (exists == std::isnan(batch.cosine[i])) return std::numeric_limits<double>::infinity();
  if (!exists) return 0.0;
  const Eigen::Vector3d t(batch.x[i], batch.y[i], batch.z[i]);
  return std::max({std::abs(batch.cosine[i] - scalar.yaw.cosine),
                   std::abs(batch.sine[i] - scalar.yaw.sine),
                   (t - scalar.translation).cwiseAbs().maxCoeff()});
}

struct Solved {
  AlignedPoseArrays first, second;
  std::size_t conditioned = 0;
};

Solved SolveUp2p(Batch& batch, std::size_t count, double least = 0.0) {
  Solved solved = {batch.Out(), batch.Out()};
  solved.conditioned =
      SolveUp2pBatch({batch.In(&Sample::ray1), batch.In(&Sample::point1), batch.In(&Sample::ray2),
                      batch.In(&Sample::point2), count, least},
                     solved.first, solved.second);
  return solved;
}

Solved SolveUp1p1l(Batch& batch, std::size_t count, double least = 0.0) {
  Solved solved = {batch.Out(), batch.Out()};
  solved.conditioned = SolveUp1p1lBatch(
      {batch.In(&Sample::ray1), batch.In(&Sample::point1), batch.In(&Sample::normal),
       batch.In(&Sample::point2), batch.In(&Sample::direction), count, least},
      solved.first, solved.second);
  return solved;
}

// Without a gate.
constexpr auto kUp2p = [](Batch& batch, std::size_t count) { return SolveUp2p(batch, count); };
constexpr auto kUp1p1l = [](Batch& batch, std::size_t count) { return SolveUp1p1l(batch, count); };

int ScalarUp2p(const Sample& s, AlignedPose poses[2]) {
  return maploc::SolveUp2p(s.ray1, s.point1, s.ray2, s.point2, poses);
}
int ScalarUp1p1l(const Sample& s, AlignedPose poses[2]) {
  return maploc::SolveUp1p1l(s.ray1, s.point1, s.normal, s.point2, s.direction, poses);
}

// Whether the batch says what the scalar kernel says: the same solutions in the same order.
template <typename SolveBatch, typename SolveScalar, typename Conditioning>
void ExpectAgreement(const SolveBatch& solve_batch, const SolveScalar& solve_scalar,
                     const Conditioning& conditioning, int count, Random& random) {
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    do {
      samples.resize(i);
      samples.push_back(MakeSample(i, random));
    } while (conditioning(samples.back()) < 0.1);
  }
  Batch batch(samples);
  const Solved solved = solve_batch(batch, samples.size());
  for (int i = 0; i < count; ++i) {
    AlignedPose poses[2];
    const int scalar = solve_scalar(samples[i], poses);
    // Which of the two roots a single one is, the batch must tell.
    const bool first = scalar == 2 || (scalar == 1 && !std::isnan(solved.first.cosine[i]));
    const bool second = scalar == 2 || (scalar == 1 && !first);
    EXPECT_LT(Difference(solved.first, i, first, poses[0]), 1e-12) << i << " of " << count;
    EXPECT_LT(Difference(solved.second, i, second, poses[scalar - 1 > 0 ? 1 : 0]), 1e-12)
        << i << " of " << count;
  }
  EXPECT_EQ(solved.first.cosine[count], Batch::kUntouched);
  EXPECT_EQ(solved.second.z[count], Batch::kUntouched);
}

class BatchOnTarget : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override {
    if ((hwy::SupportedTargets() & GetParam()) == 0) {
      GTEST_SKIP() << hwy::TargetName(GetParam()) << " is not on this processor";
    }
    hwy::SetSupportedTargetsForTest(GetParam());
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

// The conditioning of a pair or line, and of its depths: a sample at its limit magnifies rounding.
double OfUp2p(const Sample& s) {
  const double rays = s.ray1.normalized().cross(s.ray2.normalized()).norm();
  return std::min(rays, Up2pConditioning(s.ray1, s.point1, s.ray2, s.point2));
}
double OfUp1p1l(const Sample& s) {
  const double off_line = std::abs(s.normal.normalized().dot(s.ray1.normalized()));
  return std::min(off_line, YawConditioning(s.normal, s.direction));
}

TEST_P(BatchOnTarget, Up2pAgreesWithTheScalarKernelAtEveryLength) {
  Random random = TestRandom();
  for (int count = 0; count <= 35; ++count) {
    ExpectAgreement(kUp2p, ScalarUp2p, OfUp2p, count, random);
  }
  ExpectAgreement(kUp2p, ScalarUp2p, OfUp2p, 20001, random);
}

TEST_P(BatchOnTarget, Up1p1lAgreesWithTheScalarKernelAtEveryLength) {
  Random random = TestRandom();
  for (int count = 0; count <= 35; ++count) {
    ExpectAgreement(kUp1p1l, ScalarUp1p1l, OfUp1p1l, count, random);
  }
  ExpectAgreement(kUp1p1l, ScalarUp1p1l, OfUp1p1l, 20001, random);
}

// The truth, as the scalar kernels are asked: 100,000 samples without noise or a gate.
TEST_P(BatchOnTarget, RecoversRandomPoses) {
  Random random = TestRandom();
  std::vector<Sample> samples;
  std::vector<Yaw> truth;
  for (int i = 0; i < kManyProblems; ++i) {
    samples.push_back(MakeSample(1, random));
    // aligned_from_map: the angle between the pair in the map and in the aligned frame.
    const Eigen::Vector3d in_map = samples.back().point2 - samples.back().point1;
    const Eigen::Vector3d in_aligned = samples.back().ray2 - samples.back().ray1;
    const double scale = in_map.head<2>().squaredNorm();
    truth.push_back({in_map.head<2>().dot(in_aligned.head<2>()) / scale,
                     (in_map.x() * in_aligned.y() - in_map.y() * in_aligned.x()) / scale});
  }
  Batch batch(samples);
  for (const Solved& solved :
       {SolveUp2p(batch, samples.size()), SolveUp1p1l(batch, samples.size())}) {
    std::vector<double> errors;
    for (int i = 0; i < kManyProblems; ++i) {
      double error = std::numbers::pi;
      for (const AlignedPoseArrays& poses : {solved.first, solved.second}) {
        if (std::isnan(poses.cosine[i])) continue;
        error = std::min(
            error, std::hypot(poses.cosine[i] - truth[i].cosine, poses.sine[i] - truth[i].sine));
      }
      errors.push_back(error);
    }
    const ErrorSummary summary = Summarize(errors);
    EXPECT_EQ(summary.missed, 0);
    EXPECT_LE(summary.percent999, 1e-11);
  }
}

// What the scalar gate (IsYawConditioned) lets through is solved, and nothing else.
TEST_P(BatchOnTarget, IllConditionedSamplesAreGated) {
  constexpr double kLeast = 0.5;
  constexpr int kCount = 1003;
  Random random = TestRandom();
  std::vector<Sample> samples;
  for (int i = 0; i < kCount; ++i) samples.push_back(MakeSample(i, random));
  Batch batch(samples);
  const auto expect_gated = [&](const Solved& open, const Solved& gated, const auto& normal,
                                const auto& direction) {
    std::size_t passed = 0;
    for (int i = 0; i < kCount; ++i) {
      const bool passes = IsYawConditioned(normal(samples[i]), direction(samples[i]), kLeast);
      passed += passes ? 1 : 0;
      EXPECT_EQ(std::isnan(gated.first.cosine[i]), !passes || std::isnan(open.first.cosine[i]));
      EXPECT_EQ(std::isnan(gated.second.cosine[i]), !passes || std::isnan(open.second.cosine[i]));
    }
    EXPECT_EQ(gated.conditioned, passed);
    EXPECT_GT(passed, samples.size() / 10);
    EXPECT_LT(passed, samples.size());
  };
  expect_gated(
      SolveUp2p(batch, kCount), SolveUp2p(batch, kCount, kLeast),
      [](const Sample& s) { return s.ray1.cross(s.ray2).eval(); },
      [](const Sample& s) { return (s.point2 - s.point1).eval(); });
  expect_gated(
      SolveUp1p1l(batch, kCount), SolveUp1p1l(batch, kCount, kLeast),
      [](const Sample& s) { return s.normal; }, [](const Sample& s) { return s.direction; });
}

TEST_P(BatchOnTarget, DegenerateSamplesAreMarked) {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const Eigen::Vector3d a(0.1, 0.2, 1), b(-0.3, 0.1, 1), up(0, 0, 1);
  const Eigen::Vector3d level(1, 0, 0.5), side(0, 1, 0);
  const std::vector<Sample> samples = {
      {a, {1, 2, 3}, a, {2, 2, 3}, zero, {1, 0, 0}},      // equal rays; no plane
      {a, {1, 2, 3}, b, {1, 2, 3}, {1, 0, 0}, up},        // equal points; a vertical line
      {level, {1, 2, 3}, b, {1, 2, 5}, side, {1, 0, 0}},  // a vertical pair; point on image line
      {zero, zero, zero, zero, zero, zero}};
  Batch batch(samples);
  for (const Solved& solved :
       {SolveUp2p(batch, samples.size()), SolveUp1p1l(batch, samples.size())}) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_TRUE(std::isnan(solved.first.cosine[i]) && std::isnan(solved.second.cosine[i])) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, BatchOnTarget,
                         ::testing::Values(HWY_SSSE3, HWY_SSE4, HWY_AVX2, HWY_AVX3),
                         [](const auto& target) { return hwy::TargetName(target.param); });

}  // namespace
}  // namespace maploc::testing
