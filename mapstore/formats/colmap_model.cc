#include <array>
#include <filesystem>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/colmap_binary.h"
#include "mapstore/formats/colmap_text.h"

namespace maploc {
namespace {

constexpr std::array<const char*, 3> kParts = {"cameras", "images", "points3D"};

bool HasAllParts(const std::string& directory, const std::string& extension) {
  for (const char* part : kParts) {
    if (!std::filesystem::exists(directory + "/" + part + extension)) return false;
  }
  return true;
}

}  // namespace

Result<ColmapModel> ReadColmapModel(const std::string& directory) {
  if (!std::filesystem::is_directory(directory)) {
    return NotFound("model folder '" + directory + "'", "FILE_NOT_FOUND");
  }
  if (HasAllParts(directory, ".bin")) return ReadColmapBinaryModel(directory);
  if (HasAllParts(directory, ".txt")) return ReadColmapTextModel(directory);
  return InvalidFile(directory,
                     "is not a COLMAP model: it needs cameras, images and points3D, all three "
                     "as .bin or all three as .txt");
}

}  // namespace maploc
