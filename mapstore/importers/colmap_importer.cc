#include "mapstore/importers/colmap_importer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "mapstore/base/clock.h"
#include "mapstore/base/name.h"
#include "mapstore/importers/descriptor_selection.h"
#include "mapstore/importers/frame_neighbours.h"
#include "mapstore/importers/imported_lines.h"
#include "mapstore/importers/model_points.h"
#include "mapstore/importers/photo_features.h"
#include "mapstore/importers/point_triangulator.h"
#include "mapstore/importers/segmenter.h"
#include "mapstore/importers/shared_error.h"
#include "mapstore/importers/source_alignment.h"

namespace maploc {
namespace {

constexpr double kAttachDistancePx = 1.0;  // of the photo as its features were found
constexpr const char* kDefaultKind = "sift_root_u8";
constexpr int kMaxDescriptors = 8;  // that a landmark keeps, the most different ones (README.md)

Status CheckOptions(const ColmapImportOptions& options) {
  if (options.map_name.empty()) return InvalidArgument("map name", "is empty");
  MAPLOC_RETURN_IF_ERROR(CheckName("map name", options.map_name));
  if (options.meters_per_unit &&
      !(*options.meters_per_unit > 0 && *options.meters_per_unit < 1e9)) {
    return InvalidArgument("scale", "must be above 0 and below 1e9, metres a unit of the model");
  }
  if (options.segment_length && !(*options.segment_length > 0 && *options.segment_length < 1e12)) {
    return InvalidArgument("segment-length", "must be above 0 and below 1e12");
  }
  if (options.database_path.empty() && options.images_directory.empty()) {
    return InvalidArgument("descriptors",
                           "need a source: give --database, or --images to detect "
                           "features in the photos");
  }
  if (options.triangulate && options.images_directory.empty()) {
    return InvalidArgument("triangulate", "needs the photos: give --images");
  }
  return Status::Ok();
}

// The stages share what has been made so far; each is called once, in order.
class Importer {
 public:
  Importer(const ColmapImportOptions& options, ProgressFn progress)
      : options_(options), progress_(std::move(progress)) {}

  Status Align() {
    MAPLOC_RETURN_IF_ERROR(CheckOptions(options_));
    MAPLOC_ASSIGN_OR_RETURN(model_, ReadColmapModel(options_.model_directory));
    if (!model_.notice.empty()) report_.notices.push_back(model_.notice);
    if (model_.images.empty()) {
      return InvalidFile(options_.model_directory, "the model has no images");
    }
    MAPLOC_RETURN_IF_ERROR(LookAtThePhotos());
    MAPLOC_ASSIGN_OR_RETURN(const GravityEvidence evidence, TakeGravityEvidence());
    MAPLOC_ASSIGN_OR_RETURN(
        report_.gravity, FindSourceGravity(evidence, options_.gravity_in_source, options_.force));
    report_.info.key.name = options_.map_name;
    report_.info.metric = options_.meters_per_unit.has_value();
    report_.info.map_from_source =
        AlignSource(report_.gravity.down_in_source, options_.meters_per_unit.value_or(1.0));
    // An angle, so it is the same in the source's frame as in the map's.
    report_.info.shared_error_rad = SharedErrorRad(model_);
    frames_ = MakeKeyFrames(model_, report_.info.map_from_source);
    report_.frames = static_cast<std::int64_t>(frames_.size());
    return Status::Ok();
  }

  Status MakePoints() {
    if (options_.triangulate) {
      MAPLOC_RETURN_IF_ERROR(TriangulateFromPhotos());
    } else {
      MAPLOC_RETURN_IF_ERROR(TakeModelPoints());
    }
    if (points_.empty()) {
      return InvalidFile(options_.model_directory,
                         "no point of the model has a descriptor (a model of poses alone needs "
                         "--images and --triangulate)");
    }
    for (const PointTrack& point : points_) {
      report_.point_descriptors +=
          static_cast<std::int64_t>(point.descriptors.size()) / report_.info.point_descriptor.bytes;
    }
    return Status::Ok();
  }

  Status MakeLines() {
    if (!options_.line_file.empty()) {
      MAPLOC_ASSIGN_OR_RETURN(ImportedLines imported,
                              ReadLines(options_.line_file, frames_, report_.info.map_from_source));
      lines_ = std::move(imported.lines);
      report_.info.line_descriptor = imported.kind;
    } else if (options_.detect_lines && !looks_.lines.empty()) {
      lines_ =
          TriangulateLines(frames_, looks_.lines, FindFrameNeighbours(frames_, points_), progress_);
      if (!lines_.empty()) report_.info.line_descriptor = looks_.lines.front().descriptors.kind;
    }
    for (LineTrackInMap& line : lines_) {
      const DescriptorKind& kind = report_.info.line_descriptor;
      line.descriptors = SelectDescriptors(kind, line.descriptors, kMaxDescriptors);
      report_.line_descriptors += static_cast<std::int64_t>(line.descriptors.size()) / kind.bytes;
      report_.usable_lines += IsUsableLine(line.segment_in_map) ? 1 : 0;
    }
    return Status::Ok();
  }

  Result<ColmapImportReport> Write(MapStore& store) {
    report_.segment_length =
        options_.segment_length.value_or(DefaultSegmentLength(frames_, points_));
    const std::vector<std::vector<int>> cuts =
        CutIntoSegments(frames_, points_, report_.segment_length);
    report_.info.created_unix_ns = SystemClock().NowUnixNanos();
    if (lines_.empty()) TellLostLines(store);
    MAPLOC_ASSIGN_OR_RETURN(const std::unique_ptr<MapWriter> writer,
                            store.BeginImport(report_.info));
    const SegmentMaker maker(frames_, {points_, report_.info.point_descriptor},
                             {lines_, report_.info.line_descriptor});
    for (const std::vector<int>& segment_frames : cuts) {
      const auto id = static_cast<SegmentId>(report_.segments++);
      MAPLOC_RETURN_IF_ERROR(writer->AddSegment(maker.Make(id, segment_frames)));
      if (progress_) progress_("writing segments", id + 1, static_cast<int>(cuts.size()));
    }
    MAPLOC_RETURN_IF_ERROR(writer->Commit(options_.publishing));
    report_.info.key = writer->key();
    report_.points = static_cast<std::int64_t>(points_.size());
    report_.lines = static_cast<std::int64_t>(lines_.size());
    TellReduced();
    if (!truncated_.empty()) {
      report_.notices.push_back(DescribeTruncated(truncated_, frames_.size()));
    }
    return report_;
  }

  // A failure may come of what the photos that were left out had to say.
  Status Explain(const Status& status) const {
    if (truncated_.empty()) return status;
    return Status(status.code(), status.reason(),
                  status.message() + "; " + DescribeTruncated(truncated_, model_.images.size()));
  }

 private:
  // Someone who forgets --images would otherwise replace a map with lines by one without,
  // unnoticed.
  void TellLostLines(const MapStore& store) {
    const Result<MapSummary> before = store.GetMap(options_.map_name);
    if (!before.ok() || before->lines == 0) return;
    const std::string version = std::to_string(before->info.key.version);
    report_.notices.push_back("the new version has no lines, but version " + version + " has " +
                              std::to_string(before->lines) +
                              "; are --images missing? `maploc-map export --version " + version +
                              "` and `import` bring the old one back");
  }

  // Lines speak of gravity and become landmarks; where gravity is given and no landmarks are asked
  // for, they are not worth their time.
  Status LookAtThePhotos() {
    const bool makes_lines = options_.detect_lines && options_.line_file.empty();
    if (options_.images_directory.empty() || (options_.gravity_in_source && !makes_lines)) {
      return Status::Ok();
    }
    looked_at_photos_ = true;
    // In the source's frame: the map's frame needs gravity, for which these lines are evidence.
    MAPLOC_ASSIGN_OR_RETURN(
        looks_, LookAtPhotos(options_.images_directory, MakeKeyFrames(model_, {}), progress_));
    truncated_.insert(looks_.truncated.begin(), looks_.truncated.end());
    return Status::Ok();
  }

  Result<GravityEvidence> TakeGravityEvidence() const {
    std::map<std::string, Eigen::Vector3d> measured;  // in the camera
    if (!options_.database_path.empty()) {
      MAPLOC_ASSIGN_OR_RETURN(measured, ReadColmapGravity(options_.database_path));
    }
    GravityEvidence evidence;
    for (const auto& [id, image] : model_.images) {
      const Eigen::Quaterniond& rotation = image.camera_from_source.rotation;
      evidence.camera_from_source.push_back(rotation);
      const auto found = measured.find(image.name);
      if (found == measured.end()) continue;
      evidence.measured_in_source.emplace_back(rotation.conjugate() * found->second);
    }
    evidence.lines = looks_.lines;
    evidence.brightening = looks_.brightening;
    return evidence;
  }

  Result<DescriptorKind> PhotoKind() const {
    if (options_.descriptors) return *options_.descriptors;
    return DescriptorKindFromName(kDefaultKind);
  }

  Status TakeModelPoints() {
    MAPLOC_ASSIGN_OR_RETURN(const std::vector<KeypointFeatures> features, ModelFeatures());
    report_.info.point_descriptor = DescriptorKind{};
    for (const KeypointFeatures& of_frame : features) {
      // A photo without features need not name a kind.
      if (of_frame.descriptors.size() == 0) continue;
      report_.info.point_descriptor = of_frame.descriptors.kind;
    }
    points_ =
        MakePointTracks(model_, report_.info.map_from_source, frames_, features, kMaxDescriptors);
    report_.points_without_descriptor =
        static_cast<std::int64_t>(model_.points.size() - points_.size());
    return Status::Ok();
  }

  void TellReduced() {
    if (!looked_at_photos_) return;
    std::vector<PixelSize> sizes;
    for (const KeyFrame& frame : frames_) {
      sizes.push_back({frame.camera.width_px(), frame.camera.height_px()});
    }
    const std::string text = DescribeReduced(sizes);
    if (!text.empty()) report_.notices.push_back(text);
  }

  Result<std::vector<PointFeatures>> DetectInPhotos(const DescriptorKind& kind) {
    looked_at_photos_ = true;
    MAPLOC_ASSIGN_OR_RETURN(PhotoPoints detected,
                            DetectPhotoPoints(options_.images_directory, frames_, kind, progress_));
    truncated_.insert(detected.truncated.begin(), detected.truncated.end());
    return std::move(detected.features);
  }

  Result<std::vector<KeypointFeatures>> ModelFeatures() {
    if (!options_.database_path.empty()) {
      MAPLOC_ASSIGN_OR_RETURN(auto database,
                              ReadColmapDatabase(options_.database_path, options_.descriptors));
      return TakeFromDatabase(model_, frames_, std::move(database));
    }
    MAPLOC_ASSIGN_OR_RETURN(const DescriptorKind kind, PhotoKind());
    MAPLOC_ASSIGN_OR_RETURN(const std::vector<PointFeatures> detected, DetectInPhotos(kind));
    std::vector<KeypointFeatures> features;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      features.push_back(AttachFeatures(model_.images.at(frames_[i].image_id), detected[i],
                                        kAttachDistancePx * frames_[i].FeaturePixel()));
    }
    return features;
  }

  Status TriangulateFromPhotos() {
    MAPLOC_ASSIGN_OR_RETURN(report_.info.point_descriptor, PhotoKind());
    MAPLOC_ASSIGN_OR_RETURN(const std::vector<PointFeatures> detected,
                            DetectInPhotos(report_.info.point_descriptor));
    points_ = TriangulatePoints(frames_, detected, FindFrameNeighbours(frames_, ModelPoints()),
                                progress_);
    for (PointTrack& point : points_) {
      point.descriptors =
          SelectDescriptors(report_.info.point_descriptor, point.descriptors, kMaxDescriptors);
    }
    return Status::Ok();
  }

  // The model's points without descriptors: they say which photos see the same things.
  std::vector<PointTrack> ModelPoints() const {
    std::vector<PointTrack> points;
    for (const auto& [id, point] : model_.points) {
      std::set<std::int32_t> seen_by;
      for (const ColmapPoint::Observation& observation : point.track) {
        const auto image = model_.images.find(observation.image_id);
        seen_by.insert(static_cast<std::int32_t>(std::distance(model_.images.begin(), image)));
      }
      points.push_back({report_.info.map_from_source * point.position_in_source,
                        {seen_by.begin(), seen_by.end()},
                        {}});
    }
    return points;
  }

  ColmapImportOptions options_;
  ProgressFn progress_;
  ColmapImportReport report_;
  ColmapModel model_;
  PhotoLooks looks_;
  bool looked_at_photos_ = false;
  std::set<std::string> truncated_;  // names of photos
  std::vector<KeyFrame> frames_;
  std::vector<PointTrack> points_;
  std::vector<LineTrackInMap> lines_;
};

}  // namespace

Result<ColmapImportReport> ImportColmap(const ColmapImportOptions& options,
                                        const OpenStoreFn& open_store, const ProgressFn& progress) {
  Importer importer(options, progress);
  Status status = importer.Align();
  if (status.ok()) status = importer.MakePoints();
  if (status.ok()) status = importer.MakeLines();
  if (!status.ok()) return importer.Explain(status);
  // Only now, so that a failed import creates no store file.
  MAPLOC_ASSIGN_OR_RETURN(MapStore* const store, open_store());
  return importer.Write(*store);
}

}  // namespace maploc
