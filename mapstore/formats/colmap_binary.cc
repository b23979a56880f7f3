#include "mapstore/formats/colmap_binary.h"

#include <functional>
#include <unordered_map>
#include <utility>

#include "mapstore/formats/byte_reader.h"
#include "mapstore/formats/colmap_builder.h"
#include "mapstore/formats/file_bytes.h"

namespace maploc {
namespace {

// The least that one record takes in its file, so that a count is refused before memory is
// allocated for it. No camera model has fewer than two parameters.
constexpr std::size_t kMinCameraBytes = 4 + 4 + 8 + 8 + 2 * 8;
constexpr std::size_t kMinImageBytes = 4 + 7 * 8 + 4 + 1 + 8;
constexpr std::size_t kKeypointBytes = 8 + 8 + 8;
constexpr std::size_t kMinPointBytes = 8 + 3 * 8 + 3 + 8 + 8;
constexpr std::size_t kObservationBytes = 4 + 4;

std::string At(const std::string& path, std::size_t offset) {
  return path + ": byte " + std::to_string(offset);
}

Status ReadCamera(ByteReader& reader, ColmapModel& model) {
  MAPLOC_ASSIGN_OR_RETURN(const auto id, reader.Read<std::uint32_t>("camera id"));
  MAPLOC_ASSIGN_OR_RETURN(const auto model_id, reader.Read<std::int32_t>("camera model"));
  const std::string_view name = ColmapModelName(model_id);
  if (name.empty()) {
    return InvalidArgument("camera model",
                           "'number " + std::to_string(model_id) +
                               "' is unknown, and so is how many parameters to skip; is the file "
                               "damaged, or newer than COLMAP 4? `colmap model_converter "
                               "--output_type TXT` writes a text model that names it");
  }
  MAPLOC_ASSIGN_OR_RETURN(const auto width, reader.Read<std::uint64_t>("camera width"));
  MAPLOC_ASSIGN_OR_RETURN(const auto height, reader.Read<std::uint64_t>("camera height"));
  std::vector<double> params(static_cast<std::size_t>(ColmapParamCount(model_id)));
  for (double& param : params) {
    MAPLOC_ASSIGN_OR_RETURN(param, reader.Read<double>("camera parameter"));
  }
  return AddColmapCamera(model, id,
                         MakeColmapCamera(name, static_cast<std::int64_t>(width),
                                          static_cast<std::int64_t>(height), std::move(params)));
}

Status ReadKeypoints(ByteReader& reader, ColmapImage& image) {
  MAPLOC_ASSIGN_OR_RETURN(const std::size_t count,
                          reader.ReadCount("number of keypoints", kKeypointBytes));
  image.keypoints_px.reserve(count);
  image.point_ids.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    MAPLOC_ASSIGN_OR_RETURN(const double x, reader.Read<double>("keypoint x"));
    MAPLOC_ASSIGN_OR_RETURN(const double y, reader.Read<double>("keypoint y"));
    MAPLOC_ASSIGN_OR_RETURN(const auto point, reader.Read<std::int64_t>("keypoint's point id"));
    // COLMAP has the centre of the first pixel at (0.5, 0.5), maploc at (0, 0).
    image.keypoints_px.emplace_back(x - 0.5, y - 0.5);
    image.point_ids.push_back(point);
  }
  return Status::Ok();
}

Result<ColmapImage> ReadImage(ByteReader& reader) {
  ColmapImage image;
  MAPLOC_ASSIGN_OR_RETURN(image.id, reader.Read<std::uint32_t>("image id"));
  std::array<double, 7> pose{};
  for (double& value : pose) {
    MAPLOC_ASSIGN_OR_RETURN(value, reader.Read<double>("pose"));
  }
  MAPLOC_ASSIGN_OR_RETURN(image.camera_from_source, MakeColmapPose(pose));
  MAPLOC_ASSIGN_OR_RETURN(image.camera_id, reader.Read<std::uint32_t>("camera id"));
  MAPLOC_ASSIGN_OR_RETURN(image.name, reader.ReadString("image name"));
  MAPLOC_RETURN_IF_ERROR(ReadKeypoints(reader, image));
  return image;
}

Status ReadPoint(ByteReader& reader, ColmapModel& model) {
  ColmapPoint point;
  MAPLOC_ASSIGN_OR_RETURN(point.id, reader.Read<std::int64_t>("point id"));
  for (int axis = 0; axis < 3; ++axis) {
    MAPLOC_ASSIGN_OR_RETURN(point.position_in_source[axis], reader.Read<double>("position"));
  }
  MAPLOC_ASSIGN_OR_RETURN([[maybe_unused]] const auto color,
                          (reader.Read<std::array<std::uint8_t, 3>>("color")));
  MAPLOC_ASSIGN_OR_RETURN(point.error_px, reader.Read<double>("error"));
  MAPLOC_ASSIGN_OR_RETURN(const std::size_t count,
                          reader.ReadCount("track length", kObservationBytes));
  point.track.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    ColmapPoint::Observation observation;
    MAPLOC_ASSIGN_OR_RETURN(observation.image_id, reader.Read<std::uint32_t>("track's image id"));
    MAPLOC_ASSIGN_OR_RETURN(observation.keypoint, reader.Read<std::int32_t>("track's keypoint"));
    point.track.push_back(observation);
  }
  return AddColmapPoint(model, std::move(point));
}

// Reads the count and each record of a file; an error gets the place of the record it is in, or of
// the byte that is missing.
Status ForEachRecord(const std::string& path, std::string_view what, std::size_t min_bytes,
                     const std::function<Status(ByteReader&)>& read) {
  MAPLOC_ASSIGN_OR_RETURN(const std::string bytes, ReadFileBytes(path));
  ByteReader reader(bytes);
  const Result<std::size_t> count = reader.ReadCount(what, min_bytes);
  if (!count.ok()) return InvalidFile(At(path, reader.offset()), count.status().message());
  for (std::size_t i = 0; i < *count; ++i) {
    if (const Status status = read(reader); !status.ok()) {
      return InvalidFile(At(path, reader.offset()), status.message());
    }
  }
  if (reader.remaining() > 0) {
    return InvalidFile(At(path, reader.offset()),
                       std::to_string(reader.remaining()) + " bytes follow the last record");
  }
  return Status::Ok();
}

}  // namespace

Result<ColmapModel> ReadColmapBinaryModel(const std::string& directory) {
  ColmapModel model;
  // Images are read before the points that they name. Where an image begins is kept for the error
  // about a point that is missing.
  std::unordered_map<std::int64_t, std::size_t> image_offsets;
  const std::string images_path = directory + "/images.bin";
  MAPLOC_RETURN_IF_ERROR(
      ForEachRecord(directory + "/cameras.bin", "number of cameras", kMinCameraBytes,
                    [&](ByteReader& reader) { return ReadCamera(reader, model); }));
  MAPLOC_RETURN_IF_ERROR(ForEachRecord(
      images_path, "number of images", kMinImageBytes, [&](ByteReader& reader) -> Status {
        const std::size_t offset = reader.offset();
        MAPLOC_ASSIGN_OR_RETURN(ColmapImage image, ReadImage(reader));
        image_offsets[image.id] = offset;
        return AddColmapImage(model, std::move(image));
      }));
  MAPLOC_RETURN_IF_ERROR(
      ForEachRecord(directory + "/points3D.bin", "number of points", kMinPointBytes,
                    [&](ByteReader& reader) { return ReadPoint(reader, model); }));
  MAPLOC_RETURN_IF_ERROR(CheckColmapPointIds(
      model, [&](std::int64_t image) { return At(images_path, image_offsets[image]); }));
  return model;
}

}  // namespace maploc
