#include <algorithm>
#include <array>
#include <vector>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/file_bytes.h"
#include "mapstore/formats/text_fields.h"
#include "mapstore/geometry/gravity_reading.h"

namespace maploc {
namespace {

constexpr std::array<std::string_view, 4> kHeader = {"name", "gx", "gy", "gz"};

struct GravityRow {
  std::string name;
  Eigen::Vector3d gravity_in_camera;
};

bool IsBlank(std::string_view text) { return TextFields(text).AtEnd(); }

// The fields of one row, apart by commas. Quotes may stand around a field, doubled where they are
// meant.
Result<std::vector<std::string>> SplitRow(std::string_view row) {
  std::vector<std::string> fields(1);
  bool in_quotes = false;
  bool after_quotes = false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const char c = row[i];
    std::string& field = fields.back();
    if (in_quotes) {
      const bool is_doubled = c == '"' && i + 1 < row.size() && row[i + 1] == '"';
      in_quotes = c != '"' || is_doubled;
      after_quotes = !in_quotes;
      if (in_quotes) field += c;
      i += is_doubled ? 1 : 0;
    } else if (c == ',') {
      fields.emplace_back();
      after_quotes = false;
    } else if (after_quotes) {
      if (!IsBlank({&c, 1})) return InvalidArgument("row", "goes on after a closing quote");
    } else if (c == '"' && IsBlank(field)) {
      field.clear();
      in_quotes = true;
    } else {
      field += c;
    }
  }
  if (in_quotes) return InvalidArgument("row", "a quote is not closed");
  return fields;
}

bool IsHeader(const std::vector<std::string>& fields) {
  return std::equal(fields.begin(), fields.end(), kHeader.begin(), kHeader.end(),
                    [](const std::string& field, std::string_view expected) {
                      return TextFields(field).Rest() == expected;
                    });
}

// All but the last three fields are the name: it may hold commas itself, without quotes.
Result<GravityRow> ParseRow(const std::vector<std::string>& fields) {
  if (fields.size() < 4) return InvalidArgument("row", "is not name,gx,gy,gz");
  GravityRow row;
  const std::size_t first_number = fields.size() - 3;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    TextFields field(fields[first_number + axis]);
    MAPLOC_ASSIGN_OR_RETURN(row.gravity_in_camera[static_cast<int>(axis)],
                            field.Number<double>("gravity"));
    if (!field.AtEnd()) return InvalidArgument("gravity", "is more than a number");
  }
  std::string name = fields[0];
  for (std::size_t i = 1; i < first_number; ++i) name += "," + fields[i];
  row.name = TextFields(name).Rest();
  if (row.name.empty()) return InvalidArgument("name", "is missing");
  MAPLOC_ASSIGN_OR_RETURN(row.gravity_in_camera, DownFromReading("gravity", row.gravity_in_camera));
  return row;
}

}  // namespace

Result<std::map<std::string, Eigen::Vector3d>> ReadGravityCsv(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  std::map<std::string, Eigen::Vector3d> gravity;
  TextLines lines(text);
  std::string_view line;
  for (bool is_first = true; lines.NextRecord(line); is_first = false) {
    const std::string where = path + ":" + std::to_string(lines.number());
    const Result<std::vector<std::string>> fields = SplitRow(line);
    if (!fields.ok()) return InvalidFile(where, fields.status().message());
    if (is_first && IsHeader(*fields)) continue;
    const Result<GravityRow> row = ParseRow(*fields);
    if (!row.ok()) return InvalidFile(where, row.status().message());
    if (!gravity.emplace(row->name, row->gravity_in_camera).second) {
      return InvalidFile(where, "image '" + row->name + "' stands twice");
    }
  }
  if (gravity.empty()) return InvalidFile(path, "holds no row name,gx,gy,gz");
  return gravity;
}

}  // namespace maploc
