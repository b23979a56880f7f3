// What a map costs that does not fit into memory: time to open it, to the first answer, memory, and
// queries a second under a budget. Not Google Benchmark: each run is a process of its own, so that
// its memory is its own.
//
//   segments_on_demand make STORE SEGMENTS LANDMARKS [FROM MAP]
//   segments_on_demand run STORE BUDGET_BYTES SECONDS THREADS
//
// `make` writes a street of SEGMENTS segments of LANDMARKS points each, four rows of 48 bytes a
// point; with FROM after the segments of that store's map. `run` asks from places along it, each
// with a prior of 2 m: 80% of the queries in a fifth of the segments. Without arguments a little of
// both, for ctest.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <thread>

#include "mapstore/base/random.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/store/sqlite_store.h"
#include "server/pipeline/localizer.h"
#include "server/sessions/map_cache.h"
#include "tests/support/files.h"

namespace maploc::testing {
namespace {

constexpr char kMap[] = "city";
constexpr double kLength = 20.0;
constexpr double kStart = 1000.0;  // far from what FROM may hold
constexpr int kRows = 4;
constexpr int kPlaces = 400;
constexpr int kFeatures = 300;
constexpr LandmarkId kFirstId = 1ll << 40;

template <typename T>
T OrExit(Result<T> result) {
  if (!result.ok()) std::cerr << result.status().ToString() << "\n", std::exit(1);
  return std::move(result).value();
}
void OrExit(const Status& status) {
  if (!status.ok()) std::cerr << status.ToString() << "\n", std::exit(1);
}

double MillisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

std::string MemoryOf(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(field)) return std::to_string(std::atol(&line[field.size() + 1]) / 1024);
  }
  return "?";
}

void AppendBytes(Random& random, int count, std::vector<std::uint8_t>& bytes) {
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(random.Below(256)));
}

void Flip(std::span<std::uint8_t> row, int bits, Random& random) {
  for (int i = 0; i < bits; ++i) row[random.Below(row.size())] ^= 1 << random.Below(8);
}

// Landmarks on both fronts of a street along x; each row some bits off the landmark's first.
Segment DrawSegment(SegmentId id, double begin, int landmarks, const DescriptorKind& kind) {
  Random random(static_cast<std::uint64_t>(id) + 1);
  Segment segment;
  segment.id = id;
  for (double x = 0.0; x <= kLength; x += 1.0) segment.path_in_map.emplace_back(begin + x, 0, 1.5);
  PointLandmarks& points = segment.points;
  points.descriptors.kind = kind;
  for (int i = 0; i < landmarks; ++i) {
    points.ids.push_back(kFirstId + static_cast<LandmarkId>(id) * landmarks + i);
    const double side = random.Below(2) == 0 ? 5.0 : -5.0;
    points.positions_in_map.emplace_back(begin + random.Uniform(0.0, kLength),
                                         side + random.Uniform(-0.5, 0.5),
                                         random.Uniform(0.0, 5.0));
    points.viewing.push_back({});
    std::vector<std::uint8_t> first;
    AppendBytes(random, kind.bytes, first);
    for (int row = 0; row < kRows; ++row) {
      std::vector<std::uint8_t> bytes = first;
      Flip(bytes, 8 * row, random);
      points.descriptors.bytes.insert(points.descriptors.bytes.end(), bytes.begin(), bytes.end());
      points.descriptor_landmark.push_back(i);
    }
  }
  segment.lines.descriptors.kind = {};
  return segment;
}

void Make(const std::string& path, int segments, int landmarks, const std::string& from,
          const std::string& map) {
  const auto store = OrExit(OpenSqliteStore(path));
  MapInfo info;
  info.key.name = kMap;
  info.metric = true;
  info.point_descriptor = {"binary48", 48, DescriptorMetric::kHamming};
  SegmentId next = 0;
  std::unique_ptr<MapStore> old;
  if (!from.empty()) {
    old = OrExit(OpenSqliteStore(from));
    info = OrExit(old->GetMap(map)).info;
  }
  const MapKey source = info.key;
  info.key.name = kMap;
  const auto writer = OrExit(store->BeginImport(info));
  if (old != nullptr) {
    for (const SegmentSummary& summary : OrExit(old->ListSegments(source))) {
      OrExit(writer->AddSegment(*OrExit(old->LoadSegment(source, summary.id))));
      ++next;
    }
  }
  for (int i = 0; i < segments; ++i, ++next) {
    OrExit(writer->AddSegment(
        DrawSegment(next, kStart + kLength * i, landmarks, info.point_descriptor)));
  }
  OrExit(writer->Commit());
}

Camera DrawnCamera() {
  return Camera::Create(CameraModel::kPinhole, 800, 600, {500, 500, 400, 300}).value();
}

// A camera in the middle of the segment that looks along the street; a third of its features are
// wrong.
Query LookAround(const Segment& segment, Random& random) {
  Eigen::Matrix3d camera_from_ahead;
  camera_from_ahead << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Eigen::Quaterniond rotation(camera_from_ahead);
  const Eigen::Vector3d place = segment.path_in_map[random.Below(segment.path_in_map.size() / 2)];
  const Rigid3 camera_from_map{rotation, -(rotation * place)};
  Query query;
  query.map = kMap;
  query.prior = PosePrior{place, 0.5};
  query.gravity = Gravity{GravityInCamera(rotation), 0.01};
  View view{DrawnCamera(), {}, {}, {}};
  view.points.descriptors.kind = segment.points.descriptors.kind;
  for (int i = 0; i < segment.points.size() && view.points.keypoints_px.size() < kFeatures; ++i) {
    const Eigen::Vector3d in_camera = camera_from_map * segment.points.positions_in_map[i];
    if (in_camera.z() < 0.5) continue;
    auto pixel = view.camera.Project(in_camera);
    if (!pixel || (pixel->array() < 0).any() || pixel->x() > 799 || pixel->y() > 599) continue;
    if (i % 3 == 0) *pixel = {random.Uniform(0, 799), random.Uniform(0, 599)};
    view.points.keypoints_px.emplace_back(
        pixel->cast<float>() + Eigen::Vector2f(random.Gaussian(0.7), random.Gaussian(0.7)));
    const auto row = segment.points.descriptors.row(kRows * i);
    auto& bytes = view.points.descriptors.bytes;
    bytes.insert(bytes.end(), row.begin(), row.end());
    Flip(std::span(bytes).last(row.size()), 16, random);
  }
  query.views.push_back(std::move(view));
  return query;
}

// 80% in the first fifth of `ids`, which are in random order.
std::vector<Query> MakeQueries(const MapStore& store, const MapKey& key) {
  Random random(7);
  std::vector<SegmentId> ids;
  for (const SegmentSummary& summary : OrExit(store.ListSegments(key))) {
    const auto& path = summary.path_in_map;
    if (!path.empty() && path.front().x() >= kStart) ids.push_back(summary.id);
  }
  for (std::size_t i = ids.size(); i > 1; --i) std::swap(ids[i - 1], ids[random.Below(i)]);
  const std::size_t fifth = std::max<std::size_t>(1, ids.size() / 5);
  std::vector<Query> queries;
  for (int i = 0; i < kPlaces; ++i) {
    const bool often = random.Uniform() < 0.8 || ids.size() == fifth;
    const SegmentId id =
        often ? ids[random.Below(fifth)] : ids[fifth + random.Below(ids.size() - fifth)];
    queries.push_back(LookAround(*OrExit(store.LoadSegment(key, id)), random));
  }
  return queries;
}

void Run(const std::string& path, std::int64_t budget, double seconds, int threads) {
  const auto store = OrExit(OpenSqliteStore(path));
  const MapKey key = OrExit(store->GetMap(kMap)).info.key;
  const std::vector<Query> queries = MakeQueries(*store, key);
  const std::string before = MemoryOf("VmRSS:");
  const auto start = std::chrono::steady_clock::now();
  MapCacheOptions options;
  options.segment_bytes = budget;
  MapCache cache(store.get(), options);
  const MapCache::Snapshot map = OrExit(cache.Enabled(kMap));
  const double open_ms = MillisecondsSince(start);
  const auto ask = [&](const Query& query) {
    return OrExit(Localize(query, *map, {}, kNoDeadline, nullptr)).outcome == Outcome::kLocalized;
  };
  ask(queries.front());
  std::printf("open %.0f ms, first answer %.0f ms, VmRSS %s MB (%s before)\n", open_ms,
              MillisecondsSince(start), MemoryOf("VmRSS:").c_str(), before.c_str());
  std::atomic<int> answers = 0;
  std::atomic<int> localized = 0;
  const auto work = [&](int thread, double until_s) {
    Random random(static_cast<std::uint64_t>(100 + thread));
    const auto begin = std::chrono::steady_clock::now();
    while (MillisecondsSince(begin) < 1000 * until_s) {
      localized += ask(queries[random.Below(queries.size())]) ? 1 : 0;
      ++answers;
    }
  };
  const auto run_all = [&](double until_s) {
    answers = localized = 0;
    std::vector<std::thread> workers;
    for (int i = 0; i < threads; ++i) workers.emplace_back(work, i, until_s);
    for (std::thread& worker : workers) worker.join();
  };
  run_all(seconds);  // fills what the budget holds
  run_all(seconds);
  std::printf("%.0f queries a second, %d of %d localized, VmRSS %s MB, at most %s MB\n",
              answers / seconds, localized.load(), answers.load(), MemoryOf("VmRSS:").c_str(),
              MemoryOf("VmHWM:").c_str());
}

int Main(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    const TemporaryFolder folder;
    Make(folder.File("store"), 6, 2000, "", "");
    Run(folder.File("store"), 1'500'000, 0.2, 2);
  } else if (arguments[0] == "make" && arguments.size() >= 4) {
    const bool after = arguments.size() == 6;
    Make(arguments[1], std::stoi(arguments[2]), std::stoi(arguments[3]), after ? arguments[4] : "",
         after ? arguments[5] : "");
  } else if (arguments[0] == "run" && arguments.size() == 5) {
    Run(arguments[1], std::stoll(arguments[2]), std::stod(arguments[3]), std::stoi(arguments[4]));
  } else {
    return std::cerr << "see the head of segments_on_demand.cc\n", 2;
  }
  return 0;
}

}  // namespace
}  // namespace maploc::testing

int main(int argc, char** argv) {
  return maploc::testing::Main(std::vector<std::string>(argv + 1, argv + argc));
}
