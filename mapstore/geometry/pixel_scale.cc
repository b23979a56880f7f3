#include "mapstore/geometry/pixel_scale.h"

#include <algorithm>
#include <cmath>

namespace maploc {

double PixelScale(const Camera& camera) {
  constexpr double kVgaFocalPx = 500.0;
  const double by_size = std::hypot(camera.width_px(), camera.height_px()) / kVgaDiagonalPx;
  const double by_angle = camera.MeanFocalLengthPx() / kVgaFocalPx;
  return std::max(1.0, std::min(by_size, by_angle));
}

}  // namespace maploc
