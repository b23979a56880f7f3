#include "mapstore/store/sqlite_identity.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include <sqlite3.h>

#include "mapstore/store/sqlite_stamp.h"

namespace maploc {
namespace {

// While another process folds its log into the file a look at it may fail: the header counts pages
// that are not there yet. A log of 4 MB is folded well within this time, also on a busy disk.
constexpr std::chrono::milliseconds kLongestFold{2000};
constexpr std::chrono::milliseconds kBetweenLooks{3};

bool IsSameFile(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

bool IsSameTime(const timespec& a, const timespec& b) {
  return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

// File times have the resolution of the kernel's tick, at most 10 ms: a second write within a tick
// leaves no trace. Twice that is safe.
bool IsSettled(const struct stat& file) {
  constexpr std::int64_t kTickNs = 20'000'000;
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  const std::int64_t age_ns =
      (now.tv_sec - file.st_mtim.tv_sec) * 1'000'000'000 + now.tv_nsec - file.st_mtim.tv_nsec;
  return age_ns > kTickNs;
}

Status CannotLook(const std::string& path) {
  return Status(StatusCode::kUnavailable, "STORE_IO",
                path + ": cannot be looked at (" + std::strerror(errno) + "); check the disk");
}

bool HasMoved(SqliteDatabase& database) {
  int moved = 0;
  sqlite3_file_control(database.handle(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  return moved != 0;
}

}  // namespace

SqliteIdentity::SqliteIdentity(std::string path, const std::string& real_path)
    : path_(std::move(path)), beside_{{{real_path + "-wal", {}}, {real_path + "-shm", {}}}} {}

Result<std::unique_ptr<SqliteIdentity>> SqliteIdentity::Of(SqliteDatabase& database) {
  const char* file = sqlite3_db_filename(database.handle(), "main");
  std::unique_ptr<SqliteIdentity> identity(new SqliteIdentity(database.path(), file));
  const std::lock_guard lock(identity->mutex_);
  Stat now{};
  if (stat(identity->path_.c_str(), &now) != 0) return CannotLook(identity->path_);
  for (Beside& beside : identity->beside_) {
    if (stat(beside.path.c_str(), &beside.seen) != 0) return CannotLook(beside.path);
  }
  // SQLite followed links when it opened the file. If the path leads to another file now, the store
  // was replaced while it was being opened.
  struct stat real {};
  const bool same = stat(file, &real) == 0 && IsSameFile(real, now);
  if (!same || HasMoved(database)) {
    return identity->Fail(State::kMoved, "was replaced by another file", "open it again");
  }
  identity->Keep(now, identity->StampNow());
  return identity;
}

Status SqliteIdentity::Fail(State state, const std::string& what, const std::string& cure) {
  state_ = state;
  failed_ =
      Status(StatusCode::kUnavailable, "STORE_REPLACED",
             path_ + ": the store " + what +
                 " while this program had it open; all further requests are rejected; " + cure);
  return failed_;
}

Result<struct stat> SqliteIdentity::LookAtPaths() {
  if (!failed_.ok()) return failed_;
  const std::string restore = "`maploc-map restore --store " + path_ + " --from BACKUP`";
  Stat file{};
  if (stat(path_.c_str(), &file) != 0) {
    // Any other error may pass, so it is reported without condemning the store for good.
    if (errno != ENOENT && errno != ENOTDIR) return CannotLook(path_);
    return Fail(State::kMoved, "was deleted or moved away",
                "stop the server, put the store back or use " + restore + ", and start it again");
  }
  if (!IsSameFile(file, file_)) {
    return Fail(State::kMoved, "was replaced by another file",
                "restart the server to serve that file (and replace stores with " + restore + ")");
  }
  MAPLOC_RETURN_IF_ERROR(LookBeside());
  return file;
}

Status SqliteIdentity::LookBeside() {
  for (const Beside& beside : beside_) {
    Stat now{};
    const bool there = stat(beside.path.c_str(), &now) == 0;
    if (!there && errno != ENOENT) return CannotLook(beside.path);
    if (there && IsSameFile(now, beside.seen)) continue;
    return Fail(State::kMoved, "lost " + beside.path + ", which was deleted or replaced",
                "restart the server; never remove or replace that file by hand");
  }
  return Status::Ok();
}

void SqliteIdentity::Keep(const Stat& file, std::optional<std::int64_t> stamp) {
  file_ = file;
  settled_ = IsSettled(file);
  stamp_ = stamp;
}

bool SqliteIdentity::IsSame(const Stat& now) const {
  return now.st_size == file_.st_size && IsSameTime(now.st_mtim, file_.st_mtim) &&
         IsSameTime(now.st_ctim, file_.st_ctim) && settled_;
}

Status SqliteIdentity::CheckPaths() {
  const std::lock_guard lock(mutex_);
  return LookAtPaths().status();
}

bool SqliteIdentity::IsUnchanged() {
  const std::lock_guard lock(mutex_);
  const Result<Stat> now = LookAtPaths();
  return now.ok() && IsSame(*now);
}

Status SqliteIdentity::Check(SqliteDatabase& database) {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const Stat now, LookAtPaths());
  return IsSame(now) ? Status::Ok() : CheckContent(database, now);
}

std::optional<std::int64_t> SqliteIdentity::StampNow() {
  const std::unique_lock lock = HoldLooks();
  const auto give_up = std::chrono::steady_clock::now() + kLongestFold;
  while (true) {
    const Result<StampInFile> found = ReadStampInFile(path_);
    if (found.ok()) return found->stamp;
    if (std::chrono::steady_clock::now() >= give_up) return std::nullopt;
    std::this_thread::sleep_for(kBetweenLooks);
  }
}

// While a transaction runs, no checkpoint writes what the transaction does not see. So the stamp in
// the file lies between the one at the last look and the transaction's own. A missing stamp
// compares as smaller than any: it is right in a store without stamps, and wrong in a file that had
// one.
Status SqliteIdentity::CheckContent(SqliteDatabase& database, const Stat& now) {
  const Result<std::optional<std::int64_t>> newest = ReadStamp(database);
  const std::optional<std::int64_t> in_file = StampNow();
  if (in_file >= stamp_ && !newest.ok()) return newest.status();
  if (in_file >= stamp_ && in_file <= *newest) return Keep(now, in_file), Status::Ok();
  // The stamp is another file's if one was moved to the path since `now`. Then the log belongs to
  // the file that went, and must reach it.
  MAPLOC_RETURN_IF_ERROR(LookAtPaths().status());
  return Fail(State::kOverwritten, "was written over by another program",
              "stop the server, use `maploc-map restore --store " + path_ +
                  " --from BACKUP`, and start it again");
}

}  // namespace maploc
