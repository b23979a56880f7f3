// Where the log goes: standard error, without ever waiting for a reader that stands still. A pipe
// that nobody reads would else stop every thread that logs, those that write statistics among them,
// and a stopping server with them. Thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string_view>

#include <spdlog/common.h>

namespace maploc {

class LogFile {
 public:
  // `file` stays the caller's.
  explicit LogFile(int file) : file_(file) {}
  // Of this process; its lines lie in one piece, whichever of its sinks they come from.
  static LogFile& StandardError();

  // The whole line. Where it cannot be written for 200 ms it is lost, and so are further ones at
  // once, until there is room again.
  void Write(std::string_view line);
  // Lines that were lost since the last call, if there is room to tell of them.
  std::int64_t TakeLost();

 private:
  // REQUIRES: mutex_ is held (both).
  bool HasRoom();
  bool WritePiece(std::string_view piece);

  const int file_;
  std::mutex mutex_;
  bool stands_still_ = false;
  bool in_line_ = false;  // the last line was cut
  std::int64_t lost_ = 0;
};

// As spdlog formats them. The sink of the default logger tells before its next line how many lines
// of all sinks were lost.
enum class LostLines { kTold, kUntold };
spdlog::sink_ptr NewLogSink(LogFile& file, LostLines lost);

}  // namespace maploc
