#include "server/sessions/health.h"

#include <spdlog/spdlog.h>

#include "server/sessions/caught.h"

namespace maploc {

void Health::Run(const std::string& part, const std::function<Status()>& round) {
  const Status status = Caught(round);
  // Telling of it may need memory, too.
  static_cast<void>(Caught([&] { return Report(part, status), Status::Ok(); }));
}

void Health::Report(const std::string& part, const Status& status) {
  const std::lock_guard lock(mutex_);
  const auto before = failing_.find(part);
  if (status.ok()) {
    if (before == failing_.end()) return;
    spdlog::info("{}: works again", part);
    failing_.erase(before);
  } else {
    const bool told = before != failing_.end() && before->second.reason() == status.reason();
    if (!told) spdlog::error("{}: {}", part, status.ToString());
    failing_[part] = status;
  }
  if (good_.exchange(failing_.empty()) != failing_.empty() && turned_) turned_();
}

}  // namespace maploc
