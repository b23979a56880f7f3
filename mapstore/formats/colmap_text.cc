#include "mapstore/formats/colmap_text.h"

#include <functional>
#include <unordered_map>
#include <utility>

#include "mapstore/formats/colmap_builder.h"
#include "mapstore/formats/file_bytes.h"
#include "mapstore/formats/text_fields.h"

namespace maploc {
namespace {

std::string At(const std::string& path, std::int64_t line) {
  return path + ":" + std::to_string(line);
}

struct CameraRecord {
  std::int64_t id = 0;
  Result<Camera> camera;  // of an unsupported model: why not
};

// CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
Result<CameraRecord> ParseCamera(std::string_view line) {
  TextFields fields(line);
  MAPLOC_ASSIGN_OR_RETURN(const auto id, fields.Number<std::int64_t>("camera id"));
  const std::string_view model = fields.Word();
  MAPLOC_ASSIGN_OR_RETURN(const auto width, fields.Number<std::int64_t>("camera width"));
  MAPLOC_ASSIGN_OR_RETURN(const auto height, fields.Number<std::int64_t>("camera height"));
  std::vector<double> params;
  while (!fields.AtEnd()) {
    MAPLOC_ASSIGN_OR_RETURN(const double param, fields.Number<double>("camera parameter"));
    params.push_back(param);
  }
  return CameraRecord{id, MakeColmapCamera(model, width, height, std::move(params))};
}

// IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
Result<ColmapImage> ParseImageHeader(std::string_view line) {
  TextFields fields(line);
  ColmapImage image;
  MAPLOC_ASSIGN_OR_RETURN(image.id, fields.Number<std::int64_t>("image id"));
  std::array<double, 7> pose{};
  for (std::size_t i = 0; i < pose.size(); ++i) {
    MAPLOC_ASSIGN_OR_RETURN(pose[i], fields.Number<double>(i < 4 ? "rotation" : "translation"));
  }
  MAPLOC_ASSIGN_OR_RETURN(image.camera_from_source, MakeColmapPose(pose));
  MAPLOC_ASSIGN_OR_RETURN(image.camera_id, fields.Number<std::int64_t>("camera id"));
  // The rest of the line, because a name may contain blanks.
  image.name = fields.Rest();
  return image;
}

// POINTS2D[] as (X, Y, POINT3D_ID)
Status ParseKeypoints(std::string_view line, ColmapImage& image) {
  TextFields fields(line);
  while (!fields.AtEnd()) {
    MAPLOC_ASSIGN_OR_RETURN(const double x, fields.Number<double>("keypoint x"));
    MAPLOC_ASSIGN_OR_RETURN(const double y, fields.Number<double>("keypoint y"));
    MAPLOC_ASSIGN_OR_RETURN(const auto point, fields.Number<std::int64_t>("keypoint's point id"));
    // COLMAP has the centre of the first pixel at (0.5, 0.5), maploc at (0, 0).
    image.keypoints_px.emplace_back(x - 0.5, y - 0.5);
    image.point_ids.push_back(point);
  }
  return Status::Ok();
}

// POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)
Result<ColmapPoint> ParsePoint(std::string_view line) {
  TextFields fields(line);
  ColmapPoint point;
  MAPLOC_ASSIGN_OR_RETURN(point.id, fields.Number<std::int64_t>("point id"));
  for (int axis = 0; axis < 3; ++axis) {
    MAPLOC_ASSIGN_OR_RETURN(point.position_in_source[axis], fields.Number<double>("position"));
  }
  for (int channel = 0; channel < 3; ++channel) {
    MAPLOC_ASSIGN_OR_RETURN([[maybe_unused]] const int value, fields.Number<int>("color"));
  }
  // Some programs write NaN for an error that they do not know.
  MAPLOC_ASSIGN_OR_RETURN(point.error_px, fields.AnyNumber<double>("error"));
  while (!fields.AtEnd()) {
    ColmapPoint::Observation observation;
    MAPLOC_ASSIGN_OR_RETURN(observation.image_id, fields.Number<std::int64_t>("track's image id"));
    MAPLOC_ASSIGN_OR_RETURN(observation.keypoint, fields.Number<std::int32_t>("track's keypoint"));
    point.track.push_back(observation);
  }
  return point;
}

// Calls `parse` for each record of the file and gives its error the place.
Status ForEachRecord(const std::string& path,
                     const std::function<Status(std::string_view, TextLines&)>& parse) {
  MAPLOC_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  TextLines lines(text);
  std::string_view line;
  while (lines.NextRecord(line)) {
    if (const Status status = parse(line, lines); !status.ok()) {
      return InvalidFile(At(path, lines.number()), status.message());
    }
  }
  return Status::Ok();
}

Status ReadCameras(const std::string& path, ColmapModel& model) {
  return ForEachRecord(path, [&](std::string_view line, TextLines&) -> Status {
    MAPLOC_ASSIGN_OR_RETURN(CameraRecord record, ParseCamera(line));
    return AddColmapCamera(model, record.id, std::move(record.camera));
  });
}

// The very next line, which is blank for an image without keypoints. Some programs leave that blank
// line out: what is no list of keypoints but the next image's header is left to be read again.
Status ReadKeypoints(TextLines& lines, ColmapImage& image) {
  const TextLines before = lines;
  std::string_view line;
  if (!lines.Next(line)) return Status::Ok();
  const Status status = ParseKeypoints(line, image);
  if (status.ok() || !ParseImageHeader(line).ok()) return status;
  lines = before;
  image.keypoints_px.clear();
  image.point_ids.clear();
  return Status::Ok();
}

using ImageLines = std::unordered_map<std::int64_t, std::int64_t>;

Status ReadImages(const std::string& path, ColmapModel& model, ImageLines& image_lines) {
  return ForEachRecord(path, [&](std::string_view line, TextLines& lines) -> Status {
    MAPLOC_ASSIGN_OR_RETURN(ColmapImage image, ParseImageHeader(line));
    const std::int64_t id = image.id;
    MAPLOC_RETURN_IF_ERROR(ReadKeypoints(lines, image));
    image_lines[id] = lines.number();
    return AddColmapImage(model, std::move(image));
  });
}

Status ReadPoints(const std::string& path, ColmapModel& model) {
  return ForEachRecord(path, [&](std::string_view line, TextLines&) -> Status {
    MAPLOC_ASSIGN_OR_RETURN(ColmapPoint point, ParsePoint(line));
    return AddColmapPoint(model, std::move(point));
  });
}

}  // namespace

Result<ColmapModel> ReadColmapTextModel(const std::string& directory) {
  ColmapModel model;
  ImageLines image_lines;
  const std::string images_path = directory + "/images.txt";
  MAPLOC_RETURN_IF_ERROR(ReadCameras(directory + "/cameras.txt", model));
  MAPLOC_RETURN_IF_ERROR(ReadImages(images_path, model, image_lines));
  MAPLOC_RETURN_IF_ERROR(ReadPoints(directory + "/points3D.txt", model));
  MAPLOC_RETURN_IF_ERROR(CheckColmapPointIds(
      model, [&](std::int64_t image) { return At(images_path, image_lines[image]); }));
  return model;
}

Result<Camera> ParseColmapCameraLine(const std::string& line, const std::string& where) {
  Result<CameraRecord> record = ParseCamera(WithoutByteOrderMark(line));
  if (!record.ok()) return InvalidFile(where, record.status().message());
  if (!record->camera.ok()) return InvalidFile(where, record->camera.status().message());
  return std::move(record->camera);
}

}  // namespace maploc
