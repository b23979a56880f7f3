// Work shared between the processor's cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <string_view>
#include <thread>
#include <vector>

namespace maploc {

// Told from time to time how far a stage is: done of total. Called from one thread at a time.
using ProgressFn = std::function<void(std::string_view stage, int done, int total)>;

// Calls work(i) for each i in [0, count), each once, from several threads, and returns when all are
// done. `work` must not throw and must not touch what another i touches. Progress, when given, is
// told from the calling thread alone.
inline void ParallelFor(int count, const std::function<void(int)>& work,
                        const std::function<void(int done)>& progress = nullptr) {
  std::atomic<int> next{0};
  std::atomic<int> done{0};
  const auto run = [&](bool tells) {
    for (int i = next++; i < count; i = next++) {
      work(i);
      const int finished = ++done;
      if (tells && progress) progress(finished);
    }
  };
  const int threads = std::min(count, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::jthread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back([&] { run(false); });
  run(true);
  others.clear();  // joins
  if (progress) progress(count);
}

}  // namespace maploc
