#include "server/app/log_sink.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <string>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <spdlog/sinks/base_sink.h>
#include <unistd.h>

namespace maploc {
namespace {

// A reader that is only slow, as a busy journal is, catches up within it.
constexpr int kPatienceMs = 200;

class LogSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  LogSink(LogFile& file, LostLines lost) : file_(file), lost_(lost) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    if (lost_ == LostLines::kTold) TellLost(message);
    Put(message);
  }
  void flush_() override {}  // nothing is kept back

  void TellLost(const spdlog::details::log_msg& message) {
    const std::int64_t lost = file_.TakeLost();
    if (lost == 0) return;
    const std::string text = std::to_string(lost) + " lines of the log are lost: nobody read them";
    Put({message.time, {}, message.logger_name, spdlog::level::warn, text});
  }
  void Put(const spdlog::details::log_msg& message) {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    file_.Write({line.data(), line.size()});
  }

  LogFile& file_;
  const LostLines lost_;
};

// A terminal that has room for a byte may still hold up a line. Opened anew it can be told not to,
// which would else hold for every program that writes to it.
int OpenStandardError() {
  if (isatty(STDERR_FILENO) == 0) return STDERR_FILENO;
  const int own = open("/proc/self/fd/2", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  return own >= 0 ? own : STDERR_FILENO;
}

}  // namespace

LogFile& LogFile::StandardError() {
  static LogFile file(OpenStandardError());
  return file;
}

bool LogFile::HasRoom() {
  pollfd room{file_, POLLOUT, 0};
  int ready = 0;
  do {
    ready = poll(&room, 1, stands_still_ ? 0 : kPatienceMs);
  } while (ready < 0 && errno == EINTR);
  stands_still_ = ready <= 0;
  return !stands_still_;
}

bool LogFile::WritePiece(std::string_view piece) {
  while (!piece.empty()) {
    if (!HasRoom()) return false;
    const ssize_t written = write(file_, piece.data(), piece.size());
    if (written < 0 && errno == EINTR) continue;
    // The reader has gone, the disk is full, or the terminal stands still.
    if (written < 0) return false;
    piece.remove_prefix(static_cast<std::size_t>(written));
    in_line_ = true;
  }
  return true;
}

void LogFile::Write(std::string_view line) {
  const std::lock_guard lock(mutex_);
  bool whole = !in_line_ || WritePiece("\n");
  // A pipe that has room takes PIPE_BUF bytes without waiting, and may wait for more.
  while (whole && !line.empty()) {
    whole = WritePiece(line.substr(0, PIPE_BUF));
    line.remove_prefix(std::min<std::size_t>(line.size(), PIPE_BUF));
  }
  if (whole) {
    in_line_ = false;
  } else {
    ++lost_;
  }
}

std::int64_t LogFile::TakeLost() {
  const std::lock_guard lock(mutex_);
  if (lost_ == 0 || !HasRoom()) return 0;
  return std::exchange(lost_, 0);
}

spdlog::sink_ptr NewLogSink(LogFile& file, LostLines lost) {
  return std::make_shared<LogSink>(file, lost);
}

}  // namespace maploc
