// Work shared between the processor's cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

namespace maploc {

// Told from time to time how far a stage is: done of total. Called from one thread at a time.
using ProgressFn = std::function<void(std::string_view stage, int done, int total)>;

// Calls work(i) for each i in [0, count), each once, from several threads, and returns when all are
// done. `work` must not touch what another i touches. What it throws (memory that is used up) ends
// the whole: no other i is begun, and the first exception is thrown to the caller. Progress, when
// given, is told from the calling thread alone.
inline void ParallelFor(int count, const std::function<void(int)>& work,
                        const std::function<void(int done)>& progress = nullptr) {
  std::atomic<int> next{0};
  std::atomic<int> done{0};
  std::once_flag failed;
  std::exception_ptr failure;
  const auto run = [&](bool tells) {
    try {
      for (int i = next++; i < count; i = next++) {
        work(i);
        const int finished = ++done;
        if (tells && progress) progress(finished);
      }
    } catch (...) {
      // An exception that left a thread would end the process.
      std::call_once(failed, [&failure] { failure = std::current_exception(); });
      next = count;
    }
  };
  const int threads = std::min(count, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::jthread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back([&] { run(false); });
  run(true);
  others.clear();  // joins
  if (failure) std::rethrow_exception(failure);
  if (progress) progress(count);
}

}  // namespace maploc
