#include "client/robot/camera_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "mapstore/base/path_kind.h"
#include "mapstore/formats/colmap.h"
#include "mapstore/formats/euroc.h"

namespace maploc {
namespace {

// "1, 2, 7 and 9 more"
template <typename Map>
std::string IdsText(const Map& cameras) {
  constexpr std::size_t kShown = 12;
  std::string text;
  std::size_t count = 0;
  for (const auto& [id, camera] : cameras) {
    if (count++ == kShown) break;
    text += (text.empty() ? "" : ", ") + std::to_string(id);
  }
  const std::size_t more = cameras.size() - std::min(cameras.size(), kShown);
  return text + (more > 0 ? " and " + std::to_string(more) + " more" : "");
}

// The camera of the image whose name is the end of the photo's path; of several the longest name.
class CameraOfPhoto {
 public:
  explicit CameraOfPhoto(const std::string& photo) {
    if (!photo.empty()) path_ = std::filesystem::absolute(photo).lexically_normal().string();
  }
  void Consider(const std::string& name, std::int64_t camera_id) {
    // With the slash, so that '11.jpg' is not taken for '1.jpg'. The longest, because a model may
    // have both '1.jpg' and 'left/1.jpg'.
    if (name.size() <= longest_ || !path_.ends_with("/" + name)) return;
    longest_ = name.size();
    camera_id_ = camera_id;
  }
  const std::optional<std::int64_t>& camera_id() const { return camera_id_; }

 private:
  std::string path_;
  std::size_t longest_ = 0;
  std::optional<std::int64_t> camera_id_;
};

template <typename Map>
Result<std::int64_t> Choose(const CameraChoice& choice, const Map& cameras,
                            const std::optional<std::int64_t>& of_photo) {
  const bool only_one = cameras.size() == 1 && !choice.camera_id;
  const std::optional<std::int64_t> id = choice.camera_id ? choice.camera_id
                                         : only_one       ? std::optional(cameras.begin()->first)
                                                          : of_photo;
  if (id && cameras.contains(*id)) return *id;
  if (id) {
    return Status(StatusCode::kNotFound, "NO_CAMERA",
                  choice.file + ": has no camera " + std::to_string(*id) +
                      (choice.camera_id ? "" : ", which the image list gives the photo") +
                      ", only " + IdsText(cameras));
  }
  return Status(StatusCode::kInvalidArgument, "AMBIGUOUS_CAMERA",
                choice.file + ": holds " + std::to_string(cameras.size()) + " cameras (" +
                    IdsText(cameras) + "), and no image list beside it names the photo '" +
                    choice.photo + "'; say which camera took it with --camera-id N");
}

// A file to read by lines; the mark that some editors put before UTF-8 is passed over.
std::ifstream OpenText(const std::string& path) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::ifstream file(path);
  for (const char expected : kByteOrderMark) {
    if (file.peek() != std::char_traits<char>::to_int_type(expected)) break;
    file.get();
  }
  // A file shorter than the mark has been opened well; whoever reads it tells what it lacks.
  file.clear(file.rdstate() & ~std::ios::eofbit);
  return file;
}

struct CameraLine {
  std::string line;
  std::string where;
};

constexpr char kWhatCamerasAre[] =
    "; it must be a line of COLMAP's cameras.txt, such as '1 PINHOLE 640 480 500 500 320 240', or "
    "an EuRoC sensor.yaml";

// By id.
Result<std::map<std::int64_t, CameraLine>> ReadCameraLines(const std::string& path) {
  std::ifstream file = OpenText(path);
  if (!file) return NotFound("camera file '" + path + "'", "FILE_NOT_FOUND");
  std::map<std::int64_t, CameraLine> lines;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::string where = path + ":" + std::to_string(number);
    std::int64_t id = 0;
    const auto parsed = std::from_chars(line.data() + first, line.data() + line.size(), id);
    // A database or a photo given as the camera file has no number here. Taken as camera 0, it
    // would be refused on its second line, because camera 0 stands twice.
    if (parsed.ec != std::errc()) {
      return InvalidFile(where, std::string("is no camera") + kWhatCamerasAre);
    }
    if (!lines.emplace(id, CameraLine{line, where}).second) {
      return InvalidFile(where, "camera " + std::to_string(id) + " stands twice");
    }
  }
  if (!lines.empty()) return lines;
  return InvalidFile(path, std::string("holds no camera") + kWhatCamerasAre);
}

// images.txt has two lines an image: "ID QW QX QY QZ TX TY TZ CAMERA NAME", then its keypoints,
// which may be a blank line. Where there is no such file, no image is considered.
void ConsiderImageList(const std::string& path, CameraOfPhoto& of_photo) {
  std::ifstream file = OpenText(path);
  std::string line;
  while (std::getline(file, line)) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    std::istringstream fields(line);
    std::string skipped;
    for (int i = 0; i < 8; ++i) fields >> skipped;
    std::int64_t camera_id = 0;
    std::string name;
    if (fields >> camera_id && std::getline(fields >> std::ws, name)) {
      of_photo.Consider(name.substr(0, name.find_last_not_of(" \t\r") + 1), camera_id);
    }
    std::getline(file, line);
  }
}

// In lower case, with the dot: a SENSOR.YAML is no cameras.txt.
std::string Extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Result<Camera> ReadFromText(const CameraChoice& choice) {
  MAPLOC_ASSIGN_OR_RETURN(const auto lines, ReadCameraLines(choice.file));
  CameraOfPhoto of_photo(choice.photo);
  const std::filesystem::path folder = std::filesystem::path(choice.file).parent_path();
  if (lines.size() > 1 && !choice.camera_id) {
    ConsiderImageList((folder / "images.txt").string(), of_photo);
  }
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t id, Choose(choice, lines, of_photo.camera_id()));
  return ParseColmapCameraLine(lines.at(id).line, lines.at(id).where);
}

Result<Camera> ReadFromModel(const CameraChoice& choice, const std::string& folder) {
  MAPLOC_ASSIGN_OR_RETURN(const ColmapModel model, ReadColmapModel(folder));
  if (model.cameras.empty()) return InvalidFile(folder, "the model has no camera");
  CameraOfPhoto of_photo(choice.photo);
  for (const auto& [id, image] : model.images) of_photo.Consider(image.name, image.camera_id);
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t id,
                          Choose(choice, model.cameras, of_photo.camera_id()));
  return model.cameras.at(id);
}

}  // namespace

Result<Camera> ReadCameraFile(const CameraChoice& choice) {
  const std::string& file = choice.file;
  const std::string extension = Extension(file);
  if (extension == ".yaml" || extension == ".yml") {
    if (!choice.camera_id) return ReadEurocSensorYaml(file);
    return InvalidArgument("--camera-id", "chooses among COLMAP's cameras; " + file +
                                              " holds one camera, so leave it out");
  }
  if (IsFolder(file)) return ReadFromModel(choice, file);
  if (extension == ".bin") {
    const std::string folder = std::filesystem::path(file).parent_path().string();
    return ReadFromModel(choice, folder.empty() ? "." : folder);
  }
  return ReadFromText(choice);
}

}  // namespace maploc
