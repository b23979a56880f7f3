// COLMAP's files: sparse models (text or binary) and database.db, read once for importers and
// recorded robots. Everything is validated; an error names the file and the line (text) or the byte
// offset (binary) or the table and row (database). All pixels leave this folder in maploc's
// convention: half a pixel is subtracted from principal points and keypoints.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mapstore/base/status.h"
#include "mapstore/geometry/camera.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/descriptor.h"
#include "mapstore/model/query.h"

namespace maploc {

struct ColmapImage {
  std::int64_t id = 0;
  std::int64_t camera_id = 0;
  std::string name;  // relative to the image folder, "map/0000.jpg"
  Rigid3 camera_from_source;
  std::vector<Eigen::Vector2d> keypoints_px;
  std::vector<std::int64_t> point_ids;  // one a keypoint; -1: none
};

struct ColmapPoint {
  std::int64_t id = 0;
  Eigen::Vector3d position_in_source = Eigen::Vector3d::Zero();
  double error_px = 0.0;
  struct Observation {
    std::int64_t image_id = 0;
    std::int32_t keypoint = 0;  // index into the image's keypoints
  };
  std::vector<Observation> track;
};

struct ColmapModel {
  std::map<std::int64_t, Camera> cameras;
  // Cameras that no image uses and that maploc cannot compute, with the reason.
  std::map<std::int64_t, Status> unsupported_cameras;
  std::map<std::int64_t, ColmapImage> images;
  std::map<std::int64_t, ColmapPoint> points;
  // What was read where the folder holds both forms, or a part that is newer; else empty.
  std::string notice;
};

// Reads DIR/{cameras,images,points3D}.{bin,txt}; as COLMAP does, binary where both stand. A text
// file that is newer than its binary one may be an edit that is meant: then both are read, and
// models that differ are refused. A model without points (a session of reference poses) is fine.
Result<ColmapModel> ReadColmapModel(const std::string& directory);

// One line of cameras.txt: "1 PINHOLE 1536 1024 fx fy cx cy". `where` names it in errors.
Result<Camera> ParseColmapCameraLine(const std::string& line, const std::string& where);

struct ColmapFeatures {
  std::int64_t image_id = 0;
  std::string name;
  PointFeatures points;  // keypoint columns 2, 4 or 6; rows of keypoints and descriptors agree
  std::vector<float> scales_px;  // one a keypoint, 0 where it is not finite; empty with 2 columns
};

// The features of all images in database.db, by image name. `kind`: empty name means guess (learned
// float32: unitN; 128 columns: sift_root_u8, others binaryN).
Result<std::map<std::string, ColmapFeatures>> ReadColmapDatabase(
    const std::string& path, const std::optional<DescriptorKind>& kind = std::nullopt);

// Gravity as the photos' sensors measured it, from COLMAP 4's table pose_priors: unit, down, in the
// camera frame, by image name. Images without a measurement (no row, NULL or NaN) are left out, and
// so are all of a database that has no such table or column. Error: a blob that is not three
// float64, or a direction of no length.
Result<std::map<std::string, Eigen::Vector3d>> ReadColmapGravity(const std::string& path);

// "name,gx,gy,gz" with '#' comments and a header line: gravity, down, in the camera frame, unit or
// in m/s^2 (geometry/gravity_reading.h), by image name; normalized.
Result<std::map<std::string, Eigen::Vector3d>> ReadGravityCsv(const std::string& path);

}  // namespace maploc
