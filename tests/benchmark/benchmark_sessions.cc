// What statistics cost a query: the lease on its session and the record of its observation, while a
// thread writes what was recorded to a store on disk. Median, 99% and worst are over single
// queries, in microseconds; the target of the median is 50.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <vector>

#include <benchmark/benchmark.h>

#include "mapstore/store/sqlite_store.h"
#include "server/sessions/map_cache.h"
#include "server/sessions/session_manager.h"
#include "tests/contract/store/store_fixture.h"
#include "tests/support/files.h"

namespace maploc::testing {
namespace {

constexpr int kQueriesAThread = 5000;

// The store, and what all threads of a run have measured.
struct Bench {
  Bench() : map(GiveMap(*store)) {
    manager = SessionManager::Create(store.get(), SessionManagerOptions()).value();
  }

  const TemporaryFolder folder;
  const std::unique_ptr<MapStore> store = OpenSqliteStore(folder.File("store")).value();
  const MapKey map;
  std::unique_ptr<SessionManager> manager;
  std::mutex mutex;
  std::vector<double> microseconds;
};

void Report(Bench& bench, benchmark::State& state) {
  std::ranges::sort(bench.microseconds);
  const auto at = [&](double q) {
    return bench.microseconds[static_cast<std::size_t>(
        q * static_cast<double>(bench.microseconds.size() - 1))];
  };
  state.counters["p50_us"] = at(0.5);
  state.counters["p99_us"] = at(0.99);
  state.counters["max_us"] = at(1.0);
}

// One robot a thread. Between two queries it waits as long as a fast localization takes, so that
// the run lasts over several groups of the writing thread.
void BM_StatisticsOfAQuery(benchmark::State& state) {
  static std::unique_ptr<Bench> bench;
  if (state.thread_index() == 0) bench = std::make_unique<Bench>();
  std::vector<double> mine;
  SessionId id;
  for (auto _ : state) {
    if (id.empty()) id = bench->manager->Start({bench->map, "rover", {}, ""}).value().id;
    const auto start = std::chrono::steady_clock::now();
    {
      auto lease = bench->manager->Enter(id);
      benchmark::DoNotOptimize(lease->Record(Seen(1, 0)));
    }
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    mine.push_back(spent.count() * 1e6);
    state.SetIterationTime(spent.count());
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  const std::lock_guard lock(bench->mutex);
  bench->microseconds.insert(bench->microseconds.end(), mine.begin(), mine.end());
  if (bench->microseconds.size() != static_cast<std::size_t>(state.threads() * kQueriesAThread))
    return;
  Report(*bench, state);
}
BENCHMARK(BM_StatisticsOfAQuery)
    ->Iterations(kQueriesAThread)
    ->Threads(1)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_StatisticsOfAQuery)
    ->Iterations(kQueriesAThread)
    ->Threads(16)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

// The end of a session with one query in one segment, with so many ended sessions behind it that
// saw the same segment. (20,000 take two minutes to make: MEASUREMENTS.md has them.)
void BM_EndOfASession(benchmark::State& state) {
  const TemporaryFolder folder;
  const std::unique_ptr<MapStore> store = OpenSqliteStore(folder.File("store")).value();
  const MapKey map = GiveMap(*store);
  std::int64_t sessions = 0;
  const auto end_one = [&] {
    const SessionId id = "session" + std::to_string(sessions);
    Session session = OpenSession(id, map);
    session.start_unix_ns = ++sessions;
    if (!store->StartSession(session).ok()) std::abort();
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Observation> last = {Seen(1, 0)};
    if (!store->EndSession(id, SessionEnd::kByRobot, sessions, last).ok()) std::abort();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  while (sessions < state.range(0)) end_one();
  for (auto _ : state) state.SetIterationTime(end_one());
}
BENCHMARK(BM_EndOfASession)
    ->Arg(100)
    ->Arg(2'000)
    ->Iterations(200)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

// What a server does after the end of a session that changed one segment of so many: it looks for
// strategies that are new.
void BM_RefreshAfterAnEnd(benchmark::State& state) {
  const TemporaryFolder folder;
  const std::unique_ptr<MapStore> store = OpenSqliteStore(folder.File("store")).value();
  const MapKey map = GiveMap(*store, "yard", static_cast<int>(state.range(0)));
  MapCacheOptions options;
  options.poll_interval = std::chrono::hours(1);
  MapCache cache(store.get(), options);
  if (!cache.Enabled(map.name).ok()) std::abort();
  int pins = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const Strategy pinned = ++pins % 2 == 0 ? Strategy::k2P : Strategy::k1P1L;
    if (!store->PinStrategy(map, 0, pinned).ok()) std::abort();
    state.ResumeTiming();
    if (!cache.Refresh().ok()) std::abort();
  }
}
BENCHMARK(BM_RefreshAfterAnEnd)
    ->Arg(10)
    ->Arg(1'000)
    ->Iterations(100)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace maploc::testing
