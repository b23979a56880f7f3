// How long does an import beside a server keep EndSessions waiting? Two processes on one store: one
// imports a large map again and again, the other ends sessions of three segments each. Prints the
// median, the 99th percentile and the greatest of the EndSessions, without and with the import.
//
//   import_delay [sessions] [points of a segment]
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "tests/contract/store/store_fixture.h"
#include "tests/support/files.h"

namespace maploc::testing {
namespace {

constexpr int kSegments = 40;

Segment LargeSegment(SegmentId id, int points) {
  Segment segment = YardSegment(id);
  segment.points.ids.clear();
  segment.points.positions_in_map.clear();
  segment.points.descriptor_landmark.clear();
  for (int i = 0; i < points; ++i) {
    segment.points.ids.push_back(static_cast<LandmarkId>(id) * points + i);
    segment.points.positions_in_map.push_back({10.0 * id + 0.001 * i, 4.0 + 0.37 * (i % 17), 0.7});
    for (int copy = 0; copy < 4; ++copy) segment.points.descriptor_landmark.push_back(i);
  }
  segment.points.descriptors.bytes.assign(segment.points.descriptor_landmark.size() * 32,
                                          static_cast<std::uint8_t>(id));
  return segment;
}

// Until it is killed.
[[noreturn]] void ImportForEver(const std::string& path, int points) {
  const auto store = OpenSqliteStore(path).value();
  while (true) {
    auto writer = store->BeginImport(YardInfo()).value();
    for (SegmentId id = 0; id < kSegments; ++id) {
      if (const Status status = writer->AddSegment(LargeSegment(id, points)); !status.ok()) {
        std::fprintf(stderr, "import: %s\n", status.ToString().c_str());
        _exit(1);
      }
    }
    if (const Status status = writer->Commit(); !status.ok()) {
      std::fprintf(stderr, "import: %s\n", status.ToString().c_str());
      _exit(1);
    }
  }
}

void EndSessions(MapStore& store, const MapKey& key, const std::string& name, int sessions) {
  std::vector<double> delays_ms;
  for (int i = 0; i < sessions; ++i) {
    const SessionId id = name + std::to_string(i);
    if (!store.StartSession(OpenSession(id, key, 1000 + i)).ok()) std::abort();
    std::vector<Observation> seen;
    for (int q = 1; q <= 30; ++q) seen.push_back(Seen(q, q % 3));
    const auto start = std::chrono::steady_clock::now();
    if (!store.EndSession(id, SessionEnd::kByRobot, 9000, seen).ok()) std::abort();
    delays_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count());
    usleep(20000);
  }
  std::sort(delays_ms.begin(), delays_ms.end());
  std::printf("%-8s EndSession ms: median %.1f, p99 %.1f, greatest %.1f (%d sessions)\n",
              name.c_str(), delays_ms[delays_ms.size() / 2], delays_ms[delays_ms.size() * 99 / 100],
              delays_ms.back(), sessions);
}

int Run(int sessions, int points) {
  const TemporaryFolder folder;
  const std::string path = folder.File("store.db");
  const auto store = OpenSqliteStore(path).value();
  const MapKey key = GiveMap(*store);
  EndSessions(*store, key, "alone", sessions);
  const pid_t importer = fork();
  if (importer == 0) ImportForEver(path, points);
  EndSessions(*store, key, "beside", sessions);
  kill(importer, SIGKILL);
  int status = 0;
  waitpid(importer, &status, 0);
  const auto newest = store->GetMap("yard");
  std::printf("versions imported meanwhile: %lld\n",
              static_cast<long long>(newest->info.key.version - 1));
  return WIFSIGNALED(status) ? 0 : 1;
}

}  // namespace
}  // namespace maploc::testing

int main(int argc, char** argv) {
  const int sessions = argc > 1 ? std::atoi(argv[1]) : 300;
  const int points = argc > 2 ? std::atoi(argv[2]) : 20000;
  return maploc::testing::Run(std::max(sessions, 1), std::max(points, 1));
}
