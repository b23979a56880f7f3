// Thresholds, gates and sigmas are said in pixels of a VGA-sized image; here is what they are worth
// in another one.
#pragma once

#include "mapstore/geometry/camera.h"

namespace maploc {

// Pixels of the camera's image that are worth one of a VGA-sized image (a diagonal of 800 pixels, a
// focal length of 500: 65 degrees wide); at least 1.
//
// Errors of the map, of keypoints found on coarse scales and of an imperfect calibration are errors
// of angle, so that they grow with the pixels a radian; a tele lens, of more pixels a radian on no
// more pixels, is as sharp as its image is fine, and a wide lens on many pixels has no more of
// them a radian. So the smaller of diagonal / 800 and focal length / 500 counts. Below 1 a
// keypoint's own error of a pixel is what is left.
double PixelScale(const Camera& camera);

inline constexpr double kVgaDiagonalPx = 800.0;

}  // namespace maploc
