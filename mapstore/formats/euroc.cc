#include "mapstore/formats/euroc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "mapstore/formats/file_bytes.h"
#include "mapstore/formats/text_fields.h"

namespace maploc {
namespace {

struct Value {
  std::string text;
  std::string where;  // file:line
};
using Values = std::map<std::string, Value, std::less<>>;

constexpr std::array<std::string_view, 5> kKeys = {"camera_model", "intrinsics", "distortion_model",
                                                   "distortion_coefficients", "resolution"};

// The text without a comment, blanks and quotes around it.
std::string_view Trim(std::string_view text) {
  // In YAML '#' begins a comment only at the start or after a blank.
  for (std::size_t hash = text.find('#'); hash != std::string_view::npos;
       hash = text.find('#', hash + 1)) {
    if (hash > 0 && text[hash - 1] != ' ' && text[hash - 1] != '\t') continue;
    text = text.substr(0, hash);
    break;
  }
  text = TextFields(text).Rest();
  if (text.size() < 2 || (text.front() != '"' && text.front() != '\'')) return text;
  return text.front() == text.back() ? text.substr(1, text.size() - 2) : text;
}

// A key that matters, "" for others. Kalibr has another word for EuRoC's.
std::string_view FindKey(std::string_view text) {
  if (text == "distortion_coeffs") text = "distortion_coefficients";
  const auto* found = std::find(kKeys.begin(), kKeys.end(), text);
  return found == kKeys.end() ? std::string_view() : *found;
}

// A list that goes on in the next lines, in brackets or with a dash before each element, becomes
// one in brackets.
void ReadRestOfList(TextLines& lines, std::string& value) {
  const bool is_block = value.empty();
  TextLines next = lines;
  std::string_view line;
  while (is_block || (value.front() == '[' && value.back() != ']')) {
    if (!next.NextRecord(line)) break;
    const std::string_view element = Trim(line);
    if (element.find(':') != std::string_view::npos) break;  // the next key
    if (is_block && !element.starts_with("- ")) break;
    if (is_block) value += value.empty() ? "" : ", ";
    value += is_block ? element.substr(2) : " " + std::string(element);
    lines = next;
  }
  if (is_block) value = "[" + value + "]";
}

// The "key: value" lines that matter, however deep they stand.
Result<Values> ReadKeys(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  Values values;
  TextLines lines(text);
  std::string_view line;
  while (lines.NextRecord(line)) {
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    const std::string_view key = FindKey(Trim(line.substr(0, colon)));
    if (key.empty()) continue;
    Value value{std::string(Trim(line.substr(colon + 1))),
                path + ":" + std::to_string(lines.number())};
    if (values.contains(key)) {
      return InvalidFile(value.where, std::string(key) +
                                          " stands twice; a file of several cameras must be cut "
                                          "into one each");
    }
    ReadRestOfList(lines, value.text);
    values.emplace(std::string(key), std::move(value));
  }
  for (const std::string_view key : kKeys) {
    if (!values.contains(key)) {
      return InvalidFile(path, "has no line '" + std::string(key) + ": ...'; is it a sensor.yaml?");
    }
  }
  return values;
}

// "[a, b, c]" of exactly `count` numbers.
Result<std::vector<double>> ParseList(const Value& value, std::size_t count) {
  const std::string& text = value.text;
  const Status wrong =
      InvalidFile(value.where, "must be a list of " + std::to_string(count) + " numbers");
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') return wrong;
  std::string inner = text.substr(1, text.size() - 2);
  if (std::count(inner.begin(), inner.end(), ',') != static_cast<std::ptrdiff_t>(count) - 1) {
    return wrong;
  }
  std::replace(inner.begin(), inner.end(), ',', ' ');
  std::vector<double> numbers;
  TextFields fields(inner);
  while (!fields.AtEnd()) {
    const Result<double> number = fields.Number<double>("list");
    if (!number.ok()) return InvalidFile(value.where, number.status().message());
    numbers.push_back(*number);
  }
  if (numbers.size() != count) return wrong;
  return numbers;
}

Result<CameraModel> ParseModel(const Values& values) {
  const Value& projection = values.find("camera_model")->second;
  if (projection.text != "pinhole") {
    return InvalidFile(projection.where,
                       "camera_model '" + projection.text + "' is not supported; pinhole is");
  }
  const Value& distortion = values.find("distortion_model")->second;
  const std::string& name = distortion.text;
  // The short names are Kalibr's.
  if (name == "radial-tangential" || name == "radtan") return CameraModel::kOpenCv;
  if (name == "equidistant" || name == "equi") return CameraModel::kOpenCvFisheye;
  return InvalidFile(distortion.where, "distortion_model '" + distortion.text +
                                           "' is not supported; radial-tangential (radtan) "
                                           "and equidistant (equi) are");
}

}  // namespace

Result<Camera> ReadEurocSensorYaml(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(const Values values, ReadKeys(path));
  MAPLOC_ASSIGN_OR_RETURN(const CameraModel model, ParseModel(values));
  MAPLOC_ASSIGN_OR_RETURN(std::vector<double> params,
                          ParseList(values.find("intrinsics")->second, 4));
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<double> distortion,
                          ParseList(values.find("distortion_coefficients")->second, 4));
  const Value& resolution = values.find("resolution")->second;
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<double> sides, ParseList(resolution, 2));
  for (const double side : sides) {
    if (!(side >= 1 && side <= kMaxImageSidePx) || side != std::floor(side)) {
      return InvalidFile(resolution.where, "resolution must be two whole numbers in [1, 65536]");
    }
  }
  // No half pixel is subtracted: EuRoC has the centre of the first pixel at (0, 0), as maploc.
  params.insert(params.end(), distortion.begin(), distortion.end());
  Result<Camera> camera = Camera::Create(model, static_cast<int>(sides[0]),
                                         static_cast<int>(sides[1]), std::move(params));
  if (!camera.ok()) {
    return InvalidFile(values.find("intrinsics")->second.where, camera.status().message());
  }
  return camera;
}

}  // namespace maploc
