#include "mapstore/formats/colmap.h"
#include "mapstore/formats/file_bytes.h"
#include "mapstore/formats/text_fields.h"
#include "mapstore/geometry/gravity_reading.h"

namespace maploc {
namespace {

constexpr std::string_view kHeader = "name,gx,gy,gz";

struct GravityRow {
  std::string name;
  Eigen::Vector3d gravity_in_camera;
};

// Splits at the last three commas: a name may hold some itself.
Result<GravityRow> ParseRow(std::string_view line) {
  GravityRow row;
  for (int axis = 2; axis >= 0; --axis) {
    const std::size_t comma = line.rfind(',');
    if (comma == std::string_view::npos) return InvalidArgument("row", "is not name,gx,gy,gz");
    TextFields field(line.substr(comma + 1));
    MAPLOC_ASSIGN_OR_RETURN(row.gravity_in_camera[axis], field.Number<double>("gravity"));
    if (!field.AtEnd()) return InvalidArgument("gravity", "is more than a number");
    line = line.substr(0, comma);
  }
  row.name = TextFields(line).Rest();
  if (row.name.empty()) return InvalidArgument("name", "is missing");
  MAPLOC_ASSIGN_OR_RETURN(row.gravity_in_camera, DownFromReading("gravity", row.gravity_in_camera));
  return row;
}

}  // namespace

Result<std::map<std::string, Eigen::Vector3d>> ReadGravityCsv(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(const std::string text, ReadFileBytes(path));
  std::map<std::string, Eigen::Vector3d> gravity;
  TextLines lines(text);
  std::string_view line;
  for (bool is_first = true; lines.NextRecord(line); is_first = false) {
    if (is_first && TextFields(line).Rest() == kHeader) continue;
    const std::string where = path + ":" + std::to_string(lines.number());
    Result<GravityRow> row = ParseRow(line);
    if (!row.ok()) return InvalidFile(where, row.status().message());
    if (!gravity.emplace(row->name, row->gravity_in_camera).second) {
      return InvalidFile(where, "image '" + row->name + "' stands twice");
    }
  }
  if (gravity.empty()) return InvalidFile(path, "holds no row name,gx,gy,gz");
  return gravity;
}

}  // namespace maploc
