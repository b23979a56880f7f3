// ns a problem of each minimal solver, with the poses it found a problem beside; OpenGV's and
// OpenCV's P3P as peers in the same run. All solve the same problems.
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>
#include <hwy/aligned_allocator.h>
#include <hwy/targets.h>
#include <opencv2/calib3d.hpp>
#include <opengv/absolute_pose/CentralAbsoluteAdapter.hpp>
#include <opengv/absolute_pose/methods.hpp>

#include "mapstore/geometry/gravity.h"
#include "server/solvers/batch.h"
#include "server/solvers/p3p.h"
#include "server/solvers/up1p1l.h"
#include "server/solvers/up1p2v.h"
#include "server/solvers/up2p.h"
#include "tests/experiments/methods/p2p1l.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr int kProblems = 1024;

// An aligned camera at `camera_from_map`; three points and two lines with their rays.
struct Problem {
  Eigen::Vector3d camera_rays[3];
  Eigen::Vector3d rays[3];  // aligned
  Eigen::Vector3d points[3];
  Eigen::Vector3d normal;         // aligned, of the line through points 1 and 2
  Eigen::Vector3d camera_normal;  // of the line through point 2 and line_end
  Eigen::Vector3d line_end;
  Eigen::Vector3d direction;
  Eigen::Vector3d vertical_normals[2];  // aligned, of the verticals through points 1 and 2
};

std::vector<Problem> MakeProblems() {
  Random random(1);
  std::vector<Problem> problems(kProblems);
  for (Problem& problem : problems) {
    const Rigid3 camera_from_map = MakeCameraFromMap(Scene::kCube, random);
    const Eigen::Matrix3d aligned_from_camera =
        CameraFromAligned(GravityInCamera(camera_from_map.rotation)).toRotationMatrix().transpose();
    for (int i = 0; i < 3; ++i) {
      problem.points[i] = {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
      const Eigen::Vector3d seen = camera_from_map * problem.points[i];
      problem.camera_rays[i] = seen / seen.z();
      problem.rays[i] = aligned_from_camera * problem.camera_rays[i];
    }
    problem.normal = problem.rays[1].cross(problem.rays[2]);
    problem.direction = problem.points[2] - problem.points[1];
    problem.line_end = {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
    problem.camera_normal =
        problem.camera_rays[2].cross(Eigen::Vector3d(camera_from_map * problem.line_end));
    for (int i = 0; i < 2; ++i) {
      problem.vertical_normals[i] = problem.rays[i + 1].cross(Eigen::Vector3d(0, 0, 1));
    }
  }
  return problems;
}

const std::vector<Problem>& Problems() {
  static const std::vector<Problem> problems = MakeProblems();
  return problems;
}

template <typename AnyProblem, typename Solve>
void RunOver(benchmark::State& state, const std::vector<AnyProblem>& problems, const Solve& solve) {
  std::int64_t found = 0;
  std::size_t i = 0;
  for (auto _ : state) {
    found += solve(problems[i]);
    i = (i + 1) % kProblems;
  }
  state.counters["solutions"] =
      static_cast<double>(found) / static_cast<double>(state.iterations());
}

template <typename Solve>
void Run(benchmark::State& state, const Solve& solve) {
  RunOver(state, Problems(), solve);
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

void BM_P2p1l(benchmark::State& state) {
  Run(state, [](const Problem& p) {
    Rigid3 poses[8];
    const int count = SolveP2p1l(p.camera_rays, p.points, p.camera_normal, p.points[2],
                                 p.points[2] - p.line_end, poses);
    benchmark::DoNotOptimize(poses);
    return count;
  });
}
BENCHMARK(BM_P2p1l);

// ---- batches

// The problems as structure of arrays, aligned; a few at a time, so that all stays in the first
// cache.
constexpr std::size_t kBatch = 128;

class Arrays {
 public:
  template <typename Get>
  VectorArrays Add(const Get& get) {
    double* axes[3];
    for (int axis = 0; axis < 3; ++axis) {
      axes[axis] = AddArray();
      for (std::size_t i = 0; i < kBatch; ++i) axes[axis][i] = get(Problems()[i])[axis];
    }
    return {axes[0], axes[1], axes[2]};
  }
  AlignedPoseArrays AddPoses() {
    return {AddArray(), AddArray(), AddArray(), AddArray(), AddArray()};
  }

 private:
  double* AddArray() {
    arrays_.push_back(hwy::AllocateAligned<double>(kBatch));
    return arrays_.back().get();
  }

  std::vector<hwy::AlignedFreeUniquePtr<double[]>> arrays_;
};

template <typename Solve>
void RunBatch(benchmark::State& state, const AlignedPoseArrays& first,
              const AlignedPoseArrays& second, const Solve& solve) {
  if ((hwy::SupportedTargets() & state.range(0)) == 0) {
    state.SkipWithError("not on this processor");
    return;
  }
  state.SetLabel(hwy::TargetName(state.range(0)));
  hwy::SetSupportedTargetsForTest(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(solve());
    benchmark::ClobberMemory();
  }
  hwy::SetSupportedTargetsForTest(0);
  const double problems = static_cast<double>(state.iterations()) * kBatch;
  int found = 0;
  for (const double* cosines : {first.cosine, second.cosine}) {
    for (std::size_t i = 0; i < kBatch; ++i) found += std::isnan(cosines[i]) ? 0 : 1;
  }
  state.counters["solutions"] = static_cast<double>(found) / kBatch;
  state.counters["each"] =
      benchmark::Counter(problems, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void BM_Up2pBatch(benchmark::State& state) {
  Arrays arrays;
  const Up2pArrays samples = {arrays.Add([](const Problem& p) { return p.rays[0]; }),
                              arrays.Add([](const Problem& p) { return p.points[0]; }),
                              arrays.Add([](const Problem& p) { return p.rays[1]; }),
                              arrays.Add([](const Problem& p) { return p.points[1]; }), kBatch};
  const AlignedPoseArrays first = arrays.AddPoses();
  const AlignedPoseArrays second = arrays.AddPoses();
  RunBatch(state, first, second, [&] { return SolveUp2pBatch(samples, first, second); });
}
BENCHMARK(BM_Up2pBatch)->Arg(HWY_SSE4)->Arg(HWY_AVX2)->Arg(HWY_AVX3);

void BM_Up1p1lBatch(benchmark::State& state) {
  Arrays arrays;
  const Up1p1lArrays samples = {arrays.Add([](const Problem& p) { return p.rays[0]; }),
                                arrays.Add([](const Problem& p) { return p.points[0]; }),
                                arrays.Add([](const Problem& p) { return p.normal; }),
                                arrays.Add([](const Problem& p) { return p.points[1]; }),
                                arrays.Add([](const Problem& p) { return p.direction; }),
                                kBatch};
  const AlignedPoseArrays first = arrays.AddPoses();
  const AlignedPoseArrays second = arrays.AddPoses();
  RunBatch(state, first, second, [&] { return SolveUp1p1lBatch(samples, first, second); });
}
BENCHMARK(BM_Up1p1lBatch)->Arg(HWY_SSE4)->Arg(HWY_AVX2)->Arg(HWY_AVX3);

// ---- peers

// A problem as OpenGV takes it: unit bearings, and an adapter made once.
struct OpenGvProblem {
  opengv::bearingVectors_t bearings;
  opengv::points_t points;
  opengv::absolute_pose::CentralAbsoluteAdapter adapter;

  explicit OpenGvProblem(const Problem& problem)
      : bearings(problem.camera_rays, problem.camera_rays + 3),
        points(problem.points, problem.points + 3),
        adapter(bearings, points) {
    for (opengv::bearingVector_t& bearing : bearings) bearing.normalize();
  }
};

template <typename Solve>
void RunOpenGv(benchmark::State& state, const Solve& solve) {
  static const std::vector<std::unique_ptr<OpenGvProblem>> problems = [] {
    std::vector<std::unique_ptr<OpenGvProblem>> made;
    for (const Problem& problem : Problems()) {
      made.push_back(std::make_unique<OpenGvProblem>(problem));
    }
    return made;
  }();
  RunOver(state, problems,
          [&](const auto& problem) { return static_cast<int>(solve(problem->adapter).size()); });
}

void BM_OpenGvP3pKneip(benchmark::State& state) {
  RunOpenGv(state, [](const auto& adapter) { return opengv::absolute_pose::p3p_kneip(adapter); });
}
BENCHMARK(BM_OpenGvP3pKneip);

void BM_OpenGvP3pGao(benchmark::State& state) {
  RunOpenGv(state, [](const auto& adapter) { return opengv::absolute_pose::p3p_gao(adapter); });
}
BENCHMARK(BM_OpenGvP3pGao);

struct OpenCvProblem {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> seen;
};

void RunOpenCv(benchmark::State& state, int method) {
  static const std::vector<OpenCvProblem> problems = [] {
    std::vector<OpenCvProblem> made;
    for (const Problem& problem : Problems()) {
      OpenCvProblem& to = made.emplace_back();
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d& p = problem.points[i];
        to.points.emplace_back(p.x(), p.y(), p.z());
        to.seen.emplace_back(problem.camera_rays[i].x(), problem.camera_rays[i].y());
      }
    }
    return made;
  }();
  const cv::Mat identity = cv::Mat::eye(3, 3, CV_64F);
  RunOver(state, problems, [&](const OpenCvProblem& problem) {
    std::vector<cv::Mat> rotations;
    std::vector<cv::Mat> translations;
    return cv::solveP3P(problem.points, problem.seen, identity, cv::noArray(), rotations,
                        translations, method);
  });
}

void BM_OpenCvP3p(benchmark::State& state) { RunOpenCv(state, cv::SOLVEPNP_P3P); }
BENCHMARK(BM_OpenCvP3p);

void BM_OpenCvAp3p(benchmark::State& state) { RunOpenCv(state, cv::SOLVEPNP_AP3P); }
BENCHMARK(BM_OpenCvAp3p);

}  // namespace
}  // namespace maploc::testing
