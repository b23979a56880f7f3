// ns a problem of each minimal solver, with the poses it found a problem beside.
#include <vector>

#include <benchmark/benchmark.h>

#include "server/solvers/p3p.h"
#include "server/solvers/up1p1l.h"
#include "server/solvers/up1p2v.h"
#include "server/solvers/up2p.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr int kProblems = 1024;

// An aligned camera at `camera_from_map`; three points and two lines with their rays.
struct Problem {
  Eigen::Vector3d gravity;
  Eigen::Vector3d camera_rays[3];
  Eigen::Vector3d rays[3];  // aligned
  Eigen::Vector3d points[3];
  Eigen::Vector3d normal;  // aligned, of the line through points 1 and 2
  Eigen::Vector3d direction;
  Eigen::Vector3d vertical_normals[2];  // aligned, of the verticals through points 1 and 2
};

std::vector<Problem> MakeProblems() {
  Random random(1);
  std::vector<Problem> problems(kProblems);
  for (Problem& problem : problems) {
    const Rigid3 camera_from_map = MakeCameraFromMap(Scene::kCube, random);
    problem.gravity = GravityInCamera(camera_from_map.rotation);
    const Eigen::Matrix3d aligned_from_camera =
        CameraFromAligned(problem.gravity).toRotationMatrix().transpose();
    for (int i = 0; i < 3; ++i) {
      problem.points[i] = {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
      const Eigen::Vector3d seen = camera_from_map * problem.points[i];
      problem.camera_rays[i] = seen / seen.z();
      problem.rays[i] = aligned_from_camera * problem.camera_rays[i];
    }
    problem.normal = problem.rays[1].cross(problem.rays[2]);
    problem.direction = problem.points[2] - problem.points[1];
    for (int i = 0; i < 2; ++i) {
      problem.vertical_normals[i] = problem.rays[i + 1].cross(Eigen::Vector3d(0, 0, 1));
    }
  }
  return problems;
}

template <typename Solve>
void Run(benchmark::State& state, const Solve& solve) {
  static const std::vector<Problem> problems = MakeProblems();
  std::int64_t found = 0;
  std::size_t i = 0;
  for (auto _ : state) {
    found += solve(problems[i]);
    i = (i + 1) % kProblems;
  }
  state.counters["solutions"] =
      static_cast<double>(found) / static_cast<double>(state.iterations());
}

void BM_Up2p(benchmark::State& state) {
  Run(state, [](const Problem& p) {
    AlignedPose poses[2];
    const int count = SolveUp2p(p.rays[0], p.points[0], p.rays[1], p.points[1], poses);
    benchmark::DoNotOptimize(poses);
    return count;
  });
}
BENCHMARK(BM_Up2p);

void BM_Up2pWithGravity(benchmark::State& state) {
  Run(state, [](const Problem& p) {
    Rigid3 poses[2];
    const int count =
        SolveUp2p(p.gravity, p.camera_rays[0], p.points[0], p.camera_rays[1], p.points[1], poses);
    benchmark::DoNotOptimize(poses);
    return count;
  });
}
BENCHMARK(BM_Up2pWithGravity);

void BM_Up1p1l(benchmark::State& state) {
  Run(state, [](const Problem& p) {
    AlignedPose poses[2];
    const int count =
        SolveUp1p1l(p.rays[0], p.points[0], p.normal, p.points[1], p.direction, poses);
    benchmark::DoNotOptimize(poses);
    return count;
  });
}
BENCHMARK(BM_Up1p1l);

void BM_Up1p2v(benchmark::State& state) {
  Run(state, [](const Problem& p) {
    AlignedPose poses[2];
    const int count = SolveUp1p2v(p.rays[0], p.points[0], p.vertical_normals[0], p.points[1],
                                  p.vertical_normals[1], p.points[2], poses);
    benchmark::DoNotOptimize(poses);
    return count;
  });
}
BENCHMARK(BM_Up1p2v);

void BM_P3p(benchmark::State& state) {
  Run(state, [](const Problem& p) {
    Rigid3 poses[4];
    const int count = SolveP3p(p.camera_rays, p.points, poses);
    benchmark::DoNotOptimize(poses);
    return count;
  });
}
BENCHMARK(BM_P3p);

}  // namespace
}  // namespace maploc::testing
