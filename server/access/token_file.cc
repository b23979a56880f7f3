#include "server/access/token_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "mapstore/base/clock.h"
#include "mapstore/store/beside_store.h"
#include "server/access/token_lines.h"

namespace maploc {
namespace {

Status Unreadable(const std::string& path, int error) {
  return Status(StatusCode::kUnavailable, "TOKENS_UNREADABLE",
                path + ": the tokens cannot be read (" + std::strerror(error) +
                    "); the file must be the server's user's own");
}

Status NotWritten(const std::string& path, int error) {
  return Status(StatusCode::kUnavailable, "TOKENS_NOT_WRITTEN",
                path + ": the tokens cannot be written (" + std::strerror(error) +
                    "); run this as the user of the store, with room on its disk");
}

// The open file; closed, and let go by other writers' locks, with it.
class File {
 public:
  explicit File(int fd) : fd_(fd) {}
  File(File&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  File& operator=(File&&) = delete;
  ~File() {
    if (fd_ >= 0) close(fd_);
  }
  int get() const { return fd_; }

 private:
  int fd_;
};

Result<std::string> ReadAll(const std::string& path, int fd) {
  std::string text;
  char buffer[1 << 16];
  while (true) {
    const ssize_t got = pread(fd, buffer, sizeof(buffer), static_cast<off_t>(text.size()));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return Unreadable(path, errno);
    if (got == 0) return text;
    text.append(buffer, static_cast<std::size_t>(got));
    if (text.size() > kMaxTokenFileBytes) {
      return InvalidFile(path, "has more than 16 MiB; take revoked tokens out of it");
    }
  }
}

// Made by root it would be root's, and the server could not read it.
void GiveToOwnerOfFolder(const std::string& path, int fd) {
  struct stat folder {};
  const std::string parent = std::filesystem::path(path).parent_path().string();
  if (geteuid() != 0 || stat(parent.empty() ? "." : parent.c_str(), &folder) != 0) return;
  static_cast<void>(!fchown(fd, folder.st_uid, folder.st_gid));
}

// One writer at a time, until the file is closed.
Result<File> OpenToWrite(const std::string& path, bool create) {
  File file(open(path.c_str(), O_RDWR | O_CLOEXEC | (create ? O_CREAT : 0), 0600));
  if (file.get() < 0) return NotWritten(path, errno);
  // A lock of the open file (OFD) and not of the process: that one is lost when the process closes
  // any descriptor of the file, as Read does.
  struct flock whole_file {};
  whole_file.l_type = F_WRLCK;
  whole_file.l_whence = SEEK_SET;
  while (fcntl(file.get(), F_OFD_SETLKW, &whole_file) != 0) {
    if (errno != EINTR) return NotWritten(path, errno);
  }
  if (create) GiveToOwnerOfFolder(path, file.get());
  return file;
}

// Behind the last whole line, on the disk when it returns; all of `line` or nothing.
Status Append(const std::string& path, int fd, std::string_view text, const std::string& line) {
  const std::size_t whole = text.empty() ? 0 : text.rfind('\n') + 1;  // npos + 1 is 0
  const auto end = static_cast<off_t>(whole);
  if (whole + line.size() > kMaxTokenFileBytes) return NotWritten(path, EFBIG);
  const bool written =
      pwrite(fd, line.data(), line.size(), end) == static_cast<ssize_t>(line.size());
  const int error = written ? 0 : errno;
  // Also what a torn line of an earlier writer leaves behind this one.
  const off_t size = written ? end + static_cast<off_t>(line.size()) : end;
  if (ftruncate(fd, size) == 0 && fsync(fd) == 0 && written) return Status::Ok();
  return NotWritten(path, error != 0 ? error : errno);
}

}  // namespace

TokenFile::TokenFile(const std::string& store_path) : path_(BesideStore(store_path, "-tokens")) {}

Result<std::optional<TokenRecords>> TokenFile::Read() const {
  const File file(open(path_.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0 && errno == ENOENT) return std::optional<TokenRecords>();
  if (file.get() < 0) return Unreadable(path_, errno);
  MAPLOC_ASSIGN_OR_RETURN(const std::string text, ReadAll(path_, file.get()));
  MAPLOC_ASSIGN_OR_RETURN(TokenRecords records, ParseTokenLines(path_, text));
  return std::optional(std::move(records));
}

Result<Token> TokenFile::Create(const Grant& grant,
                                std::optional<std::chrono::seconds> lifetime) const {
  MAPLOC_RETURN_IF_ERROR(CheckGrant(grant));
  MAPLOC_ASSIGN_OR_RETURN(const Token token, NewToken());
  MAPLOC_ASSIGN_OR_RETURN(const File file, OpenToWrite(path_, /*create=*/true));
  MAPLOC_ASSIGN_OR_RETURN(const std::string text, ReadAll(path_, file.get()));
  MAPLOC_RETURN_IF_ERROR(ParseTokenLines(path_, text).status());  // nothing behind a broken line
  TokenRecord record;
  record.grant = grant;
  record.hash = HashSecret(token.secret);
  record.created_unix_ns = SystemClock().NowUnixNanos();
  if (lifetime) {
    record.expires_unix_ns = record.created_unix_ns + std::chrono::nanoseconds(*lifetime).count();
  }
  MAPLOC_RETURN_IF_ERROR(Append(path_, file.get(), text, CreatedLine(token.id, record)));
  return token;
}

Status TokenFile::Revoke(const std::string& id) const {
  // Read first: an unknown id, or a file that is broken, is told before anything is opened to
  // write.
  MAPLOC_ASSIGN_OR_RETURN(const std::optional<TokenRecords> known, Read());
  if (!known || !known->contains(id)) return NotFound("token '" + id + "'", "TOKEN_NOT_FOUND");
  if (known->at(id).revoked_unix_ns) return Status::Ok();
  MAPLOC_ASSIGN_OR_RETURN(const File file, OpenToWrite(path_, /*create=*/false));
  MAPLOC_ASSIGN_OR_RETURN(const std::string text, ReadAll(path_, file.get()));
  return Append(path_, file.get(), text, RevokedLine(id, SystemClock().NowUnixNanos()));
}

}  // namespace maploc
