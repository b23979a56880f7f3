// What a photo's file says before its pixels: the size as stored, and EXIF's orientation. maploc
// uses the stored pixels, as COLMAP does, and never turns them: a calibration is of the sensor. So
// a message about a phone's photo must say how it is shown.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "mapstore/base/status.h"
#include "mapstore/geometry/camera.h"

namespace maploc {

struct PhotoHeader {
  int width_px = 0;  // as stored
  int height_px = 0;
  int orientation = 1;  // EXIF's, 1 to 8; 1: shown as stored

  // Shown with width and height exchanged.
  bool ShownTurned() const { return orientation >= 5; }
  // Down in the stored pixels' camera (x right, y down), where the photo was held so that it is
  // shown upright.
  Eigen::Vector3d ShownDown() const;
};

// Of a JPEG or a PNG (whose orientation is not read); nullopt for another file, or a broken one.
std::optional<PhotoHeader> ReadPhotoHeader(const std::string& path);

// INVALID_FILE (naming both sizes, the orientation where there is one, and the cure) unless the
// photo of `width_px` x `height_px` stored pixels has the camera's size. `camera_source` says where
// the camera is from.
Status CheckPhotoSize(const std::string& path, int width_px, int height_px, const Camera& camera,
                      const std::string& camera_source);

// What to know of a photo that is shown turned, as one sentence; "" for others.
std::string OrientationNote(const std::string& path);

}  // namespace maploc
