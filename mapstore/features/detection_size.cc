#include "mapstore/features/detection_size.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace maploc {
namespace {

std::int64_t Pixels(const PixelSize& size) {
  return static_cast<std::int64_t>(size.width_px) * size.height_px;
}

std::string Text(const PixelSize& size) {
  return std::to_string(size.width_px) + "x" + std::to_string(size.height_px);
}

}  // namespace

PixelSize DetectionSize(const PixelSize& photo) {
  const double pixel = DetectionPixel(photo);
  if (pixel == 1.0) return photo;
  const auto reduced = [pixel](int side) {
    // Without 1e-9 a side that divides exactly could lose a pixel by rounding.
    return std::max(1, static_cast<int>(std::floor(side / pixel + 1e-9)));
  };
  return {reduced(photo.width_px), reduced(photo.height_px)};
}

double DetectionPixel(const PixelSize& photo) {
  const double by_pixels = std::sqrt(static_cast<double>(Pixels(photo)) / kMaxDetectionPixels);
  const double by_side =
      static_cast<double>(std::max(photo.width_px, photo.height_px)) / kMaxDetectionSidePx;
  return std::max({1.0, by_pixels, by_side});
}

std::string DescribeReduced(std::span<const PixelSize> photos) {
  const auto is_large = [](const PixelSize& photo) { return DetectionPixel(photo) > 1.0; };
  const auto count = std::ranges::count_if(photos, is_large);
  if (count == 0) return "";
  const PixelSize largest = *std::ranges::max_element(photos, {}, DetectionPixel);
  return std::to_string(count) + " of " + std::to_string(photos.size()) +
         (photos.size() == 1 ? " photo is" : " photos are") +
         " large: features are found at reduced size (" + Text(largest) + " at " +
         Text(DetectionSize(largest)) + ") and told in the photo's own pixels";
}

}  // namespace maploc
