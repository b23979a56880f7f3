#include <array>
#include <filesystem>
#include <string>
#include <system_error>

#include "mapstore/base/path_kind.h"
#include "mapstore/formats/colmap.h"
#include "mapstore/formats/colmap_binary.h"
#include "mapstore/formats/colmap_difference.h"
#include "mapstore/formats/colmap_text.h"

namespace maploc {
namespace {

constexpr std::array<const char*, 3> kParts = {"cameras", "images", "points3D"};

bool HasAllParts(const std::string& directory, const std::string& extension) {
  for (const char* part : kParts) {
    if (!Exists(directory + "/" + part + extension)) return false;
  }
  return true;
}

// The first text file that was written after its binary one; "" without any.
std::string FindNewerText(const std::string& directory) {
  for (const char* part : kParts) {
    const std::string base = directory + "/" + part;
    std::error_code error;
    const auto text = std::filesystem::last_write_time(base + ".txt", error);
    if (!error && text > std::filesystem::last_write_time(base + ".bin", error) && !error) {
      return part + std::string(".txt");
    }
  }
  return "";
}

Status Ambiguous(const std::string& directory, const std::string& newer, const std::string& how) {
  return InvalidFile(directory, "holds the model twice, and " + newer +
                                    " is newer than its .bin and differs (" + how +
                                    "); move away the files (.bin or .txt) that are not meant");
}

// The text is read for the sake of what it says differently, and only where it is the newer one.
Result<ColmapModel> ReadBinaryBesideText(const std::string& directory, bool has_whole_text) {
  MAPLOC_ASSIGN_OR_RETURN(ColmapModel model, ReadColmapBinaryModel(directory));
  const std::string newer = FindNewerText(directory);
  const std::string read = directory + ": the model's .bin files were read; ";
  if (!has_whole_text) {
    if (!newer.empty()) model.notice = read + newer + " is newer, but there is no whole text model";
    return model;
  }
  if (newer.empty()) {
    model.notice = read + "the .txt files beside them are not newer";
    return model;
  }
  const Result<ColmapModel> text = ReadColmapTextModel(directory);
  if (!text.ok()) return Ambiguous(directory, newer, text.status().message());
  const std::string difference = FindModelDifference(model, *text);
  if (!difference.empty()) return Ambiguous(directory, newer, difference);
  model.notice = read + "the .txt files beside them say the same";
  return model;
}

}  // namespace

Result<ColmapModel> ReadColmapModel(const std::string& directory) {
  if (!IsFolder(directory)) {
    return NotFound("model folder '" + directory + "'", "FILE_NOT_FOUND");
  }
  const bool has_text = HasAllParts(directory, ".txt");
  // Binary first, as COLMAP reads a folder that has both.
  if (HasAllParts(directory, ".bin")) return ReadBinaryBesideText(directory, has_text);
  if (has_text) return ReadColmapTextModel(directory);
  return InvalidFile(directory,
                     "is not a COLMAP model: it needs cameras, images and points3D, all three "
                     "as .bin or all three as .txt");
}

}  // namespace maploc
