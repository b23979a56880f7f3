// Whether a store's path still names the files that its connections have open. If the store was
// moved away, deleted or overwritten while a program has it open, everything that the program
// writes would be lost with the old file.
//
// Thread-safe.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <sys/stat.h>

#include "mapstore/base/status.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

class SqliteIdentity {
 public:
  // REQUIRES: `database` uses write-ahead logging and has been written or read: its log exists.
  // UNAVAILABLE (STORE_REPLACED) where the path changes its file at this very moment.
  static Result<std::unique_ptr<SqliteIdentity>> Of(SqliteDatabase& database);

  // UNAVAILABLE (STORE_REPLACED), with cause and cure, where the path or its log's path names
  // another file or none. The failure is permanent: the program has to open the store again. Takes
  // a few microseconds.
  Status CheckPaths();
  // The same, and whether another program has written over the file. REQUIRES: `database` is in a
  // transaction. Reads the file anew where it has changed since the last look, which is rare: with
  // write-ahead logging only checkpoints write to it.
  Status Check(SqliteDatabase& database);
  // Whether the file is as the last good Check saw it.
  bool IsUnchanged();
  // Until it is released no look is taken at the file's content: half of a checkpoint is no store.
  [[nodiscard]] std::unique_lock<std::mutex> HoldLooks() { return std::unique_lock(looks_mutex_); }

  // What the checks have found so far.
  enum class State {
    kGood,
    kMoved,        // other files stand at its paths: its own log belongs to the file that went
    kOverwritten,  // its log belongs to a content that is gone, and must not reach the file
  };
  State state() const { return state_; }

 private:
  using Stat = struct stat;

  // The log and its index: without either one processes no longer see each other's work.
  struct Beside {
    std::string path;  // behind links, as SQLite names it
    Stat seen{};
  };

  SqliteIdentity(std::string path, const std::string& real_path);

  Status Fail(State state, const std::string& what, const std::string& cure);
  // The path's file, where paths are still right. REQUIRES: mutex_ is held (all below).
  Result<Stat> LookAtPaths();
  Status LookBeside();
  void Keep(const Stat& file, std::optional<std::int64_t> stamp);
  bool IsSame(const Stat& now) const;
  Status CheckContent(SqliteDatabase& database, const Stat& now);
  // Nullopt: could not be read in several attempts.
  std::optional<std::int64_t> StampNow();

  const std::string path_;  // as it was opened, links and all
  std::atomic<State> state_ = State::kGood;
  std::mutex looks_mutex_;  // taken after mutex_
  std::mutex mutex_;
  Status failed_;
  Stat file_{};                        // at the last good look at its content
  bool settled_ = false;               // then: a later write cannot bear the same time
  std::optional<std::int64_t> stamp_;  // in the file, then; it only rises
  std::array<Beside, 2> beside_;
};

}  // namespace maploc
