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
  if (Pixels(photo) <= kMaxDetectionPixels) return photo;
  const double pixel = DetectionPixel(photo);
  const auto reduced = [pixel](int side) {
    return std::max(1, static_cast<int>(std::floor(side / pixel + 1e-9)));
  };
  return {reduced(photo.width_px), reduced(photo.height_px)};
}

double DetectionPixel(const PixelSize& photo) {
  return std::max(1.0, std::sqrt(static_cast<double>(Pixels(photo)) / kMaxDetectionPixels));
}

std::string DescribeReduced(std::span<const PixelSize> photos) {
  const auto is_large = [](const PixelSize& photo) { return Pixels(photo) > kMaxDetectionPixels; };
  const auto count = std::ranges::count_if(photos, is_large);
  if (count == 0) return "";
  const PixelSize largest = *std::ranges::max_element(photos, {}, Pixels);
  return std::to_string(count) + " of " + std::to_string(photos.size()) +
         (photos.size() == 1 ? " photo is" : " photos are") +
         " large: features are found at reduced size (" + Text(largest) + " at " +
         Text(DetectionSize(largest)) + ") and told in the photo's own pixels";
}

}  // namespace maploc
