#include "mapstore/store/sqlite_log.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string_view>
#include <thread>
#include <vector>

#include "mapstore/store/sqlite_stamp.h"

namespace maploc {
namespace {

// The log's format, as SQLite's file format document gives it (big-endian).
constexpr std::size_t kHeaderBytes = 32;
constexpr std::size_t kPageSizeAt = 8;
constexpr std::size_t kSaltAt = 16;
constexpr std::size_t kFrameHeaderBytes = 24;
constexpr std::size_t kFrameSaltAt = 8;
constexpr std::size_t kSaltBytes = 8;
constexpr std::uint32_t kLargestPage = 65536;

// If another process commits or checkpoints between reading the file and reading its log, the two
// seem unrelated for a moment. A foreign log seems so every time.
constexpr int kLooks = 4;
constexpr std::chrono::milliseconds kBetweenLooks{5};

std::uint64_t BigEndian(std::span<const char> bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

// The stamp on a page of `meta`: eight bytes after its name. What an update left behind in the
// page's free space is older, so smaller.
std::optional<std::int64_t> StampOnPage(std::span<const char> page) {
  const std::string_view text(page.data(), page.size());
  std::optional<std::int64_t> largest;
  for (std::size_t at = text.find(kStampName); at != text.npos;
       at = text.find(kStampName, at + 1)) {
    const std::size_t value_at = at + kStampName.size();
    if (value_at + 8 > page.size()) break;
    const auto stamp = static_cast<std::int64_t>(BigEndian(page.subspan(value_at, 8)));
    if (stamp >= kLeastStamp) largest = std::max(stamp, largest.value_or(stamp));
  }
  return largest;
}

struct StampsInLog {
  std::int64_t first = 0;
  std::int64_t last = 0;
};

// Of the frames that belong to the log's present round (older ones have other salts). Nullopt where
// there are none.
std::optional<StampsInLog> ReadStampsInLog(const std::string& log_path, std::int64_t meta_page) {
  std::ifstream log(log_path, std::ios::binary);
  std::array<char, kHeaderBytes> header{};
  if (!log.read(header.data(), header.size())) return std::nullopt;
  const auto page_size = BigEndian(std::span(header).subspan(kPageSizeAt, 4));
  // The header's bytes may be anything, and a page of this size is allocated below.
  if (page_size == 0 || page_size > kLargestPage) return std::nullopt;
  std::optional<StampsInLog> stamps;
  std::array<char, kFrameHeaderBytes> frame{};
  std::vector<char> page(page_size);
  while (log.read(frame.data(), frame.size())) {
    const auto salt = std::span(frame).subspan(kFrameSaltAt, kSaltBytes);
    if (!std::ranges::equal(salt, std::span(header).subspan(kSaltAt, kSaltBytes))) break;
    if (BigEndian(std::span(frame).first(4)) != static_cast<std::uint64_t>(meta_page)) {
      log.seekg(static_cast<std::streamoff>(page_size), std::ios::cur);
      continue;
    }
    if (!log.read(page.data(), static_cast<std::streamsize>(page.size()))) break;
    const std::optional<std::int64_t> stamp = StampOnPage(page);
    if (stamp && !stamps) stamps = StampsInLog{*stamp, *stamp};
    if (stamp) stamps->last = std::max(stamps->last, *stamp);
  }
  return stamps;
}

// A log begins where the file stood, and the file has at most what the log holds.
bool Fits(std::int64_t in_file, const StampsInLog& log) {
  return in_file + 1 >= log.first && in_file <= log.last;
}

bool LooksForeign(const std::string& path, const std::string& log_path) {
  const Result<StampInFile> file = ReadStampInFile(path);
  if (!file.ok() || !file->stamp) return false;
  const std::optional<StampsInLog> log = ReadStampsInLog(log_path, file->page);
  return log && !Fits(*file->stamp, *log);
}

}  // namespace

Status CheckLog(const std::string& path) {
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  const std::string log_path = (error ? path : real.string()) + "-wal";
  if (const auto size = std::filesystem::file_size(log_path, error); error || size == 0) {
    return Status::Ok();
  }
  for (int look = 0; look < kLooks; ++look) {
    if (!LooksForeign(path, log_path)) return Status::Ok();
    std::this_thread::sleep_for(kBetweenLooks);
  }
  return FailedPrecondition(
      "FOREIGN_LOG",
      path + ": the store file was replaced while its write-ahead log was not empty; " + log_path +
          " belongs to the previous file; stop all programs that use the store and run "
          "`maploc-map restore --store " +
          path + " --from COPY`");
}

}  // namespace maploc
