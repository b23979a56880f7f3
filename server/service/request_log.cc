#include "server/service/request_log.h"

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <utility>

#include <spdlog/async_logger.h>
#include <spdlog/details/thread_pool.h>
#include <spdlog/spdlog.h>

#include "server/service/log_format.h"
#include "server/service/request_line.h"

namespace maploc {
namespace {

using Time = std::chrono::steady_clock::time_point;

constexpr std::size_t kWaitingLines = 4096;  // some megabytes
// How long a refusal stands for those that are like it, and how often it is looked whether it does.
constexpr std::chrono::seconds kStandsFor{10};
constexpr std::chrono::seconds kLookEvery{1};

bool IsOwnAccident(StatusCode code) {
  return code == StatusCode::kInternal || code == StatusCode::kDataLoss;
}

spdlog::level::level_enum LevelOf(const Status& status) {
  return IsOwnAccident(status.code()) ? spdlog::level::err : spdlog::level::warn;
}

struct Refusals {
  Time first;
  StatusCode code = StatusCode::kOk;
  std::int64_t more = 0;
};

}  // namespace

struct RequestLog::Impl {
  Impl(const RequestLogOptions& log_options, spdlog::sink_ptr sink, const Clock& used_clock)
      : options(log_options),
        clock(used_clock),
        // One thread, so that the lines keep their order.
        writer(std::make_shared<spdlog::details::thread_pool>(kWaitingLines, 1)),
        logger(std::make_shared<spdlog::async_logger>(
            "requests", std::move(sink), writer, spdlog::async_overflow_policy::overrun_oldest)) {
    if (options.json) logger->set_formatter(JsonMembers());
    logger->set_level(spdlog::get_level());
  }

  // Methods and reasons are the program's own words, so their number is bounded.
  // Not by caller: a whole fleet that is refused for one cause is one line.
  using Key = std::pair<std::string, std::string>;

  bool IsFirst(const FinishedRequest& request) {
    const std::lock_guard lock(mutex);
    const auto [entry, first] =
        refusals.try_emplace(Key(request.method, request.status.reason()),
                             Refusals{clock.SteadyNow(), request.status.code(), 0});
    if (!first) ++entry->second.more;
    return first;
  }

  // Ends the refusals that began before `until`.
  void EndRefusals(Time until) {
    std::map<Key, Refusals> over;
    {
      const std::lock_guard lock(mutex);
      for (auto next = refusals.begin(); next != refusals.end();) {
        const auto entry = next++;
        if (entry->second.first < until) over.insert(refusals.extract(entry));
      }
    }
    // Without the lock, because the logger has one of its own and other requests go on meanwhile.
    for (const auto& [key, entry] : over) {
      if (entry.more == 0) continue;
      logger->log(IsOwnAccident(entry.code) ? spdlog::level::err : spdlog::level::warn,
                  CountLine(key.first, key.second, entry.more, options.json));
    }
  }

  // Called with each request, which spares a timer: a server that nobody calls has nothing new to
  // tell.
  void Look() {
    const Time now = clock.SteadyNow();
    {
      const std::lock_guard lock(mutex);
      if (now < next_look) return;
      next_look = now + kLookEvery;
    }
    EndRefusals(now - kStandsFor);
  }

  bool IsChosen() { return options.every > 0 && answered++ % options.every == 0; }

  const RequestLogOptions options;
  const Clock& clock;
  std::atomic<std::uint64_t> answered = 0;
  // The logger knows it weakly; its end writes what waits.
  const std::shared_ptr<spdlog::details::thread_pool> writer;
  const std::shared_ptr<spdlog::async_logger> logger;

  std::mutex mutex;  // guards all below
  std::map<Key, Refusals> refusals;
  Time next_look;
};

RequestLog::RequestLog(const RequestLogOptions& options, std::shared_ptr<spdlog::sinks::sink> sink,
                       const Clock& clock)
    : impl_(std::make_unique<Impl>(options, std::move(sink), clock)) {}

RequestLog::~RequestLog() { impl_->EndRefusals(Time::max()); }

void RequestLog::Write(const FinishedRequest& request) {
  Impl& log = *impl_;
  log.Look();
  const bool slow = log.options.slow_ms > 0 && request.total_ms >= log.options.slow_ms;
  if (!request.status.ok()) {
    if (!log.IsFirst(request)) return;
    log.logger->log(LevelOf(request.status), RequestLine(request, log.options.json, false));
  } else if (slow || log.IsChosen()) {
    log.logger->log(slow ? spdlog::level::warn : spdlog::level::info,
                    RequestLine(request, log.options.json, slow));
  }
}

std::size_t RequestLog::lost_lines() const { return impl_->writer->overrun_counter(); }

}  // namespace maploc
