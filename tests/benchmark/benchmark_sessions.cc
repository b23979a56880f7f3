// What statistics cost a query: the lease on its session and the record of its observation, while a
// thread writes what was recorded to a store on disk. Median, 99% and worst are over single
// queries, in microseconds; the target of the median is 50.
#include <algorithm>
#include <chrono>
#include <mutex>
#include <vector>

#include <benchmark/benchmark.h>

#include "mapstore/store/sqlite_store.h"
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

}  // namespace
}  // namespace maploc::testing
