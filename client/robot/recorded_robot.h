// A robot that was recorded: a COLMAP model of reference poses, with the features of its images in
// a database, or the images themselves.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/robot/gravity_source.h"
#include "client/robot/robot.h"
#include "mapstore/formats/colmap.h"
#include "mapstore/model/map.h"

namespace maploc {

// Points of one query that a server takes: localization_service.proto.
inline constexpr int kMaxSentPoints = 20000;

struct RecordingOptions {
  std::string model_dir;  // COLMAP model; its poses are the reference
  std::string database;   // point features; may be empty
  std::string images;     // image files at images/NAME; may be empty
  GravityOptions gravity;
  // Points a query, the strongest; unset: what the server takes (20,000) of a database, and the
  // detector's own (5,000) of photos.
  std::optional<int> max_features;
};

// Features for a map: of its descriptor kinds, and none where it has none. Points come from
// `database` where given, else from `images`; lines from `images`.
class RecordedRobot : public Robot {
 public:
  // `map` says the kinds and the frame. Checks every input that a query will need, so that no
  // session is begun that cannot end: names, features, the database's kind, photos (there, whole,
  // and of the camera's size where the file's header tells), gravity. Error: what is wrong in which
  // file, of how many images, and the cure; FAILED_PRECONDITION (DESCRIPTOR_KIND_MISMATCH) when the
  // database's descriptors cannot become the map's.
  static Result<RecordedRobot> Open(const RecordingOptions& options, const MapInfo& map);

  int QueryCount() const override { return static_cast<int>(images_.size()); }
  std::string QueryName(int index) const override { return images_[index].name; }
  Result<Query> MakeQuery(int index) const override;
  Rigid3 ReferenceMapFromBody(int index) const override;
  // From the model's points that the image observes; nullopt where it has none.
  std::optional<double> SceneDepth(int index) const override;

  // What a person should know before the queries are sent, a sentence each: which form of the model
  // was read, points left out, photos that are shown turned or whose features are found reduced.
  std::vector<std::string> Notes() const;

  // The file of an image; empty without `images`.
  std::string ImagePath(int index) const;

 private:
  RecordedRobot(RecordingOptions options, MapInfo map, GravitySource gravity)
      : options_(std::move(options)), map_(std::move(map)), gravity_(std::move(gravity)) {}

  Rigid3 CameraFromMap(int index) const;
  Status AddFeatures(int index, View& view) const;
  Status CheckInputs() const;
  Status CheckDatabase() const;
  Status CheckPhotos() const;
  Status CheckPhotosWhole() const;
  std::string PointsNote() const;
  std::string OrientationNote() const;
  std::string ReducedNote() const;
  bool WantsPoints() const { return !map_.point_descriptor.name.empty(); }
  bool WantsLines() const { return !map_.line_descriptor.name.empty(); }
  bool ReadsDatabase() const { return WantsPoints() && !options_.database.empty(); }
  bool DetectsPoints() const { return WantsPoints() && options_.database.empty(); }
  bool ReadsPhotos() const { return !options_.images.empty() && (DetectsPoints() || WantsLines()); }
  std::vector<std::string> ImageNames() const;

  RecordingOptions options_;
  MapInfo map_;
  GravitySource gravity_;
  ColmapModel model_;
  std::vector<ColmapImage> images_;  // by name
  std::map<std::string, ColmapFeatures> features_;
};

// FAILED_PRECONDITION (DESCRIPTOR_KIND_MISMATCH) where ConvertToKind cannot make `want` of `have`.
Status CheckConvertible(const DescriptorKind& have, const DescriptorKind& want);

// `points` with the map's kind: the same kind, or a binary one of the same length under another
// name (COLMAP's database names none), or COLMAP's L1-root SIFT turned into plain SIFT. Else
// FAILED_PRECONDITION (DESCRIPTOR_KIND_MISMATCH).
Result<PointFeatures> ConvertToKind(PointFeatures points, const DescriptorKind& kind);

}  // namespace maploc
