// What a recorded robot looks at before its first query.

#include "client/robot/missing.h"
#include "client/robot/recorded_robot.h"
#include "mapstore/base/name.h"
#include "mapstore/base/path_kind.h"
#include "mapstore/features/features.h"
#include "mapstore/features/photo_header.h"

namespace maploc {

Status RecordedRobot::CheckInputs() const {
  // All of it before a session is started: one that fails half way has to be discarded.
  const int max_features = options_.max_features.value_or(kMaxSentPoints);
  if (max_features < 1 || max_features > kMaxSentPoints) {
    return InvalidArgument("--max-features", "must lie in 1 to " + std::to_string(kMaxSentPoints) +
                                                 ", which is what a server takes");
  }
  for (const ColmapImage& image : images_) {
    // The name is sent as the query's request_id. gRPC answers text that is not UTF-8 with
    // UNIMPLEMENTED and no message.
    const Status named = CheckName("name of image " + std::to_string(image.id), image.name);
    if (named.ok()) continue;
    return Status(named.code(), named.reason(),
                  options_.model_dir + ": " + named.message() +
                      "; rename it in the model, the database and the folder");
  }
  MAPLOC_RETURN_IF_ERROR(gravity_.CheckHas(ImageNames()));
  if (!options_.database.empty()) MAPLOC_RETURN_IF_ERROR(CheckDatabase());
  return ReadsPhotos() ? CheckPhotos() : Status::Ok();
}

Status RecordedRobot::CheckDatabase() const {
  std::vector<std::string> missing;
  for (const ColmapImage& image : images_) {
    if (!features_.contains(image.name)) missing.push_back(image.name);
  }
  if (!missing.empty()) {
    return InvalidFile(options_.database, MissingText(missing, images_.size(), "row in it") +
                                              "; give the database that the model was made of");
  }
  for (const ColmapImage& image : images_) {
    const PointFeatures& points = features_.at(image.name).points;
    if (!ReadsDatabase() || points.keypoints_px.empty()) continue;
    // One kind a database: the first image with features stands for all.
    const Status kind = CheckConvertible(points.descriptors.kind, map_.point_descriptor);
    return kind.WithContext(options_.database);
  }
  return Status::Ok();
}

Status RecordedRobot::CheckPhotosWhole() const {
  std::vector<std::string> cut;
  for (int i = 0; i < QueryCount(); ++i) {
    if (!CheckWhole(ImagePath(i)).ok()) cut.push_back(images_[i].name);
  }
  if (cut.empty()) return Status::Ok();
  return Status(StatusCode::kInvalidArgument, std::string(kTruncatedImage),
                options_.images + ": " + ListText(cut, images_.size(), "photos are truncated") +
                    "; copy them again, or take their images out of the model");
}

Status RecordedRobot::CheckPhotos() const {
  // Too small to detect anything in it: only whether there is a detector of the map's kind.
  if (DetectsPoints()) {
    MAPLOC_RETURN_IF_ERROR(DetectPoints(GrayImage{1, 1, {0}}, map_.point_descriptor).status());
  }
  std::vector<std::string> missing;
  for (int i = 0; i < QueryCount(); ++i) {
    if (!IsRegularFile(ImagePath(i))) missing.push_back(images_[i].name);
  }
  if (!missing.empty()) {
    return InvalidFile(options_.images,
                       MissingText(missing, images_.size(), "photo in it") +
                           "; --images is the folder that the model's names start from" +
                           (options_.database.empty() ? "" : ", without it points alone are sent"));
  }
  for (int i = 0; i < QueryCount(); ++i) {
    // Only JPEG and PNG tell their size here. The others are checked when they are decoded
    // (AddFeatures).
    const std::optional<PhotoHeader> header = ReadPhotoHeader(ImagePath(i));
    if (!header) continue;
    MAPLOC_RETURN_IF_ERROR(CheckPhotoSize(ImagePath(i), header->width_px, header->height_px,
                                          model_.cameras.at(images_[i].camera_id),
                                          options_.model_dir));
  }
  return CheckPhotosWhole();
}

std::string RecordedRobot::PointsNote() const {
  if (!ReadsDatabase()) return "";
  const auto most = static_cast<std::size_t>(options_.max_features.value_or(kMaxSentPoints));
  std::size_t images = 0;
  bool scales = true;
  for (const ColmapImage& image : images_) {
    const ColmapFeatures& features = features_.at(image.name);
    if (features.points.keypoints_px.size() <= most) continue;
    ++images;
    scales = scales && !features.scales_px.empty();
  }
  if (images == 0) return "";
  return std::to_string(images) + " of " + std::to_string(images_.size()) +
         " images have more than " + std::to_string(most) + " points in " + options_.database +
         "; of each " + std::to_string(most) + " are sent (--max-features), " +
         (scales ? "those of the largest scale" : "evenly chosen, for no scale is stored");
}

std::string RecordedRobot::OrientationNote() const {
  // COLMAP ignores the orientation too, so that the reference's gravity is that of the stored
  // pixels. A measured one may be that of the photo as a viewer shows it.
  if (!ReadsPhotos() || options_.gravity.csv.empty()) return "";
  int turned = 0;
  for (int i = 0; i < QueryCount(); ++i) {
    const std::optional<PhotoHeader> header = ReadPhotoHeader(ImagePath(i));
    turned += header && header->orientation != 1 ? 1 : 0;
  }
  if (turned == 0) return "";
  return std::to_string(turned) + " of " + std::to_string(images_.size()) +
         " photos have an EXIF orientation, which is ignored: the gravity of " +
         options_.gravity.csv + " must be that of the stored pixels' camera";
}

std::string RecordedRobot::ReducedNote() const {
  if (!ReadsPhotos()) return "";
  std::vector<PixelSize> sizes;
  for (const ColmapImage& image : images_) {
    const Camera& camera = model_.cameras.at(image.camera_id);
    sizes.push_back({camera.width_px(), camera.height_px()});
  }
  return DescribeReduced(sizes);
}

std::vector<std::string> RecordedRobot::Notes() const {
  std::vector<std::string> notes;
  for (std::string note : {model_.notice, PointsNote(), OrientationNote(), ReducedNote()}) {
    if (!note.empty()) notes.push_back(std::move(note));
  }
  return notes;
}

}  // namespace maploc
