// Two nearest neighbours of 2000 query descriptors, exact, one thread: ours beside OpenCV's
// BFMatcher in one run. The argument is the number of database rows.
#include <numeric>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "mapstore/base/random.h"
#include "mapstore/descriptors/distance_kernels.h"
#include "mapstore/descriptors/knn.h"

namespace maploc {
namespace {

constexpr int kQueries = 2000;
constexpr int kRowsALandmark = 4;
const DescriptorKind kBinary{"orb", 32, DescriptorMetric::kHamming};
const DescriptorKind kSift{"sift_root_u8", 128, DescriptorMetric::kL2U8};

Descriptors RandomRows(const DescriptorKind& kind, int count, std::uint64_t seed) {
  Random random(seed);
  Descriptors rows{kind, std::vector<std::uint8_t>(static_cast<std::size_t>(count) * kind.bytes)};
  for (std::uint8_t& byte : rows.bytes) byte = static_cast<std::uint8_t>(random.Next() >> 56);
  return rows;
}

std::vector<std::int32_t> Landmarks(int rows) {
  std::vector<std::int32_t> landmarks(rows);
  for (int row = 0; row < rows; ++row) landmarks[row] = row / kRowsALandmark;
  return landmarks;
}

void Neighbours(benchmark::State& state, const DescriptorKind& kind) {
  const int rows = static_cast<int>(state.range(0));
  const Descriptors queries = RandomRows(kind, kQueries, 1);
  const Descriptors database = RandomRows(kind, rows, 2);
  const std::vector<std::int32_t> landmarks = Landmarks(rows);
  for (auto _ : state) {
    benchmark::DoNotOptimize(FindNeighbours(queries, database, landmarks));
  }
  state.SetLabel(kernels::KernelTargetName());
}

// With the ratio and mutual tests.
void Matches(benchmark::State& state, const DescriptorKind& kind) {
  const int rows = static_cast<int>(state.range(0));
  const Descriptors queries = RandomRows(kind, kQueries, 1);
  const Descriptors database = RandomRows(kind, rows, 2);
  const std::vector<std::int32_t> landmarks = Landmarks(rows);
  for (auto _ : state) {
    benchmark::DoNotOptimize(MatchDescriptors(queries, database, landmarks, {.max_ratio = 0.97f}));
  }
}

cv::Mat OpenCvRows(const Descriptors& rows) {
  const cv::Mat bytes(rows.size(), rows.kind.bytes, CV_8U,
                      const_cast<std::uint8_t*>(rows.bytes.data()));
  if (rows.kind.metric == DescriptorMetric::kHamming) return bytes.clone();
  cv::Mat floats;
  bytes.convertTo(floats, CV_32F);
  return floats;
}

void OpenCvBruteForce(benchmark::State& state, const DescriptorKind& kind) {
  cv::setNumThreads(1);
  const cv::Mat queries = OpenCvRows(RandomRows(kind, kQueries, 1));
  const cv::Mat database = OpenCvRows(RandomRows(kind, static_cast<int>(state.range(0)), 2));
  const bool hamming = kind.metric == DescriptorMetric::kHamming;
  const cv::BFMatcher matcher(hamming ? cv::NORM_HAMMING : cv::NORM_L2);
  for (auto _ : state) {
    std::vector<std::vector<cv::DMatch>> matches;
    matcher.knnMatch(queries, database, matches, 2);
    benchmark::DoNotOptimize(matches);
  }
}

constexpr auto kUnit = benchmark::kMillisecond;
BENCHMARK_CAPTURE(Neighbours, hamming256, kBinary)->Arg(5000)->Arg(20000)->Arg(100000)->Unit(kUnit);
BENCHMARK_CAPTURE(OpenCvBruteForce, hamming256, kBinary)->Arg(5000)->Arg(20000)->Unit(kUnit);
BENCHMARK_CAPTURE(Matches, hamming256, kBinary)->Arg(20000)->Unit(kUnit);
BENCHMARK_CAPTURE(Neighbours, l2_128, kSift)->Arg(5000)->Arg(20000)->Arg(100000)->Unit(kUnit);
BENCHMARK_CAPTURE(OpenCvBruteForce, l2_128, kSift)->Arg(5000)->Arg(20000)->Unit(kUnit);
BENCHMARK_CAPTURE(Matches, l2_128, kSift)->Arg(20000)->Unit(kUnit);

}  // namespace
}  // namespace maploc
