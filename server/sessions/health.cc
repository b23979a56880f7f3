#include "server/sessions/health.h"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "server/sessions/caught.h"

namespace maploc {

void Health::Run(const std::string& part, const std::function<Status()>& round) {
  const auto began = clock_.SteadyNow();
  const Status status = Caught(round);
  // Telling of it may need memory, too.
  static_cast<void>(Caught([&] { return Report(part, status, began), Status::Ok(); }));
}

void Health::Report(const std::string& part, const Status& status,
                    std::chrono::steady_clock::time_point began) {
  const std::lock_guard lock(mutex_);
  if (!status.ok()) {
    // try_emplace keeps an entry that is there: `since` stays the first failing round's.
    Fail(part, status, failing_.try_emplace(part, Failure{began, "", false}).first->second);
  } else if (failing_.erase(part) > 0) {
    spdlog::info("{}: works again", part);
  }
  const bool good =
      std::ranges::none_of(failing_, [](const auto& entry) { return entry.second.bad; });
  if (good_.exchange(good) != good && turned_) turned_();
}

void Health::Fail(const std::string& part, const Status& status, Failure& failure) const {
  const bool was_bad = failure.bad;
  const bool lasts = clock_.SteadyNow() - failure.since >= kBusyMayLast;
  failure.bad = was_bad || lasts || status.reason() != "STORE_BUSY";
  if (failure.told == status.reason() && failure.bad == was_bad) return;
  failure.told = status.reason();
  if (failure.bad) {
    spdlog::error("NOT_SERVING: {}: {}", part, status.ToString());
  } else {
    spdlog::warn("{}: {}; NOT_SERVING when this lasts {} s", part, status.ToString(),
                 kBusyMayLast.count());
  }
}

}  // namespace maploc
