// EuRoC / ASL data sets: the calibration of a camera.
#pragma once

#include <string>

#include "mapstore/base/status.h"
#include "mapstore/geometry/camera.h"

namespace maploc {

// mav0/cam0/sensor.yaml, or one camera of Kalibr's camchain.yaml: camera_model pinhole with
// distortion_model radial-tangential or radtan (k1, k2, p1, p2) as CameraModel::kOpenCv, or
// equidistant as kOpenCvFisheye. Reads the five keys it needs, their lists on one line or on
// several, and nothing else of YAML. Its pixels are maploc's already. Errors name file:line, or the
// missing key.
Result<Camera> ReadEurocSensorYaml(const std::string& path);

}  // namespace maploc
