#include "proto/recording/recording.h"

#include <algorithm>
#include <charconv>
#include <deque>
#include <filesystem>
#include <map>
#include <utility>

#include "mapstore/base/path_kind.h"
#include "proto/recording/recording_file.h"

namespace maploc {
namespace {

constexpr std::string_view kPrefix = "queries-";
constexpr std::string_view kSuffix = ".recording";
constexpr std::size_t kDigits = 10;

Status NothingIn(const std::string& path) {
  return Status(StatusCode::kNotFound, "FILE_NOT_FOUND",
                path +
                    ": there is no recording; name a file or the folder of maploc-server "
                    "--recorder");
}

Result<std::vector<std::string>> FilesIn(const std::string& folder) {
  std::map<std::int64_t, std::string> files;  // by number
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto number = RecordingNumber(entry->path().filename().string());
    std::error_code none;
    if (number && entry->is_regular_file(none)) files.emplace(*number, entry->path().string());
  }
  if (error) return InvalidArgument(folder, "cannot be read: " + error.message(), "NOT_READABLE");
  if (files.empty()) return NothingIn(folder);
  std::vector<std::string> paths;
  for (auto& [number, path] : files) paths.push_back(std::move(path));
  return paths;
}

bool IsOverwritten(const Status& status) { return status.reason() == "FILE_NOT_FOUND"; }

}  // namespace

std::string RecordingName(std::int64_t number) {
  std::string digits = std::to_string(number);
  if (digits.size() < kDigits) digits.insert(0, kDigits - digits.size(), '0');
  return std::string(kPrefix) + digits + std::string(kSuffix);
}

std::optional<std::int64_t> RecordingNumber(const std::string& name) {
  if (name.size() != kPrefix.size() + kDigits + kSuffix.size()) return std::nullopt;
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return std::nullopt;
  std::int64_t number = 0;
  const char* const digits = name.data() + kPrefix.size();
  const auto [end, error] = std::from_chars(digits, digits + kDigits, number);
  if (error != std::errc() || end != digits + kDigits || number < 0) return std::nullopt;
  return number;
}

bool RecordingFilter::Matches(const RecordedQuery& query) const {
  return (map.empty() || query.map.name == map) && (robot.empty() || query.robot == robot) &&
         (outcome.empty() || OutcomeText(query.answer) == outcome);
}

Result<Recording> Recording::Open(const std::string& path) {
  if (!Exists(path)) return NothingIn(path);
  if (!IsFolder(path)) return Recording(std::vector<std::string>{path});
  MAPLOC_ASSIGN_OR_RETURN(std::vector<std::string> files, FilesIn(path));
  return Recording(std::move(files));
}

Result<std::vector<RecordPosition>> Recording::FindLast(const RecordingFilter& filter,
                                                        std::size_t most) const {
  std::deque<RecordPosition> found;
  for (std::size_t i = 0; i < files_.size(); ++i) {
    Result<RecordingFile> file = RecordingFile::Open(files_[i]);
    // The server has made room since the folder was listed.
    if (files_.size() > 1 && IsOverwritten(file.status())) continue;
    MAPLOC_RETURN_IF_ERROR(file.status());
    while (true) {
      const std::int64_t offset = file->offset();
      MAPLOC_ASSIGN_OR_RETURN(const std::optional<RecordedQuery> query, file->Next());
      if (!query) break;
      if (!filter.Matches(*query)) continue;
      found.push_back({i, offset});
      if (found.size() > most) found.pop_front();
    }
  }
  if (found.empty()) {
    return Status(StatusCode::kNotFound, "NOTHING_RECORDED",
                  "of " + std::to_string(files_.size()) +
                      " recorded files none has such a query; check map, robot and outcome");
  }
  return std::vector<RecordPosition>(found.begin(), found.end());
}

Result<RecordedQuery> Recording::Read(const RecordPosition& position) const {
  MAPLOC_ASSIGN_OR_RETURN(RecordingFile file, RecordingFile::Open(files_[position.file]));
  file.Seek(position.offset);
  MAPLOC_ASSIGN_OR_RETURN(std::optional<RecordedQuery> query, file.Next());
  if (query) return *std::move(query);
  return Status(StatusCode::kNotFound, "FILE_NOT_FOUND",
                files_[position.file] + ": was cut since it was listed; try again");
}

}  // namespace maploc
