#include "mapstore/formats/foreign_lines.h"

#include <filesystem>
#include <vector>

#include "mapstore/formats/text_fields.h"

namespace maploc {
namespace {

std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  for (TextFields fields(line); !fields.AtEnd();) words.push_back(fields.Word());
  return words;
}

bool IsCount(std::string_view word) {
  const Result<std::int64_t> count = TextFields(word).Number<std::int64_t>("count");
  return count.ok() && *count >= 0;
}

bool AreNumbers(const std::vector<std::string_view>& words) {
  for (const std::string_view word : words) {
    if (!TextFields(word).AnyNumber<double>("number").ok()) return false;
  }
  return !words.empty();
}

// N, N times two end points, M, M times camera, segment and two end points in the image.
bool IsLine3dpp(const std::vector<std::string_view>& words) {
  if (words.size() < 14 || !AreNumbers(words) || !IsCount(words[0])) return false;
  const auto segments = TextFields(words[0]).Number<std::int64_t>("count");
  if (*segments < 1 || *segments > static_cast<std::int64_t>(words.size())) return false;
  const auto views = 1 + 6 * static_cast<std::size_t>(*segments);
  if (views >= words.size() || !IsCount(words[views])) return false;
  const auto count = TextFields(words[views]).Number<std::int64_t>("count");
  // Bounded before it is multiplied: the file may hold any number.
  if (*count > static_cast<std::int64_t>(words.size())) return false;
  return static_cast<std::int64_t>(words.size() - views - 1) == 6 * *count;
}

std::string NameText(std::string_view text) {
  TextLines lines(text);
  std::vector<std::vector<std::string_view>> records;
  for (std::string_view line; records.size() < 3 && lines.NextRecord(line);) {
    records.push_back(Words(line));
  }
  if (records.empty()) return "";
  const std::vector<std::string_view>& first = records[0];
  if (first[0] == "v" && first.size() >= 4) return "a Wavefront OBJ of LIMAP or Line3D++";
  if (first[0] == "solid") return "an STL of Line3D++";
  if (first[0] == "ply") return "a PLY";
  if (IsLine3dpp(first)) return "Line3D++'s text result";
  if (records.size() < 3) return "";
  if (records[2][0] == "image_id_list") return "one of LIMAP's line tracks (finaltracks)";
  const bool is_limap = first.size() == 1 && IsCount(first[0]) && records[1].size() == 3 &&
                        AreNumbers(records[1]) && records[2].size() == 3 && AreNumbers(records[2]);
  return is_limap ? "LIMAP's line tracks (alltracks.txt)" : "";
}

}  // namespace

std::string NameForeignLines(const std::string& path, std::string_view bytes) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    const bool is_limap = std::filesystem::exists(path + "/track_0.txt", error);
    return is_limap ? "LIMAP's folder of line tracks (finaltracks)" : "";
  }
  if (bytes.starts_with("\x93NUMPY")) return "a NumPy array, such as LIMAP's lines";
  if (bytes.substr(0, 64).find("serialization::archive") != std::string_view::npos) {
    return "Line3D++'s binary result";
  }
  return NameText(bytes);
}

}  // namespace maploc
