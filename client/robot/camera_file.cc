#include "client/robot/camera_file.h"

#include <fstream>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/euroc.h"

namespace maploc {

Result<Camera> ReadCameraFile(const std::string& path) {
  if (path.ends_with(".yaml") || path.ends_with(".yml")) return ReadEurocSensorYaml(path);
  std::ifstream file(path);
  if (!file) return NotFound("camera file '" + path + "'", "FILE_NOT_FOUND");
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    return ParseColmapCameraLine(line, path + ":" + std::to_string(number));
  }
  return InvalidFile(path,
                     "holds no camera; it must be a line of COLMAP's cameras.txt, such as "
                     "'1 PINHOLE 640 480 500 500 320 240', or an EuRoC sensor.yaml");
}

}  // namespace maploc
