// The size at which features are found. A detector's memory grows with the pixels (SIFT: about 200
// bytes each), so a large photo is reduced first; features are told in the photo's own pixels.
#pragma once

#include <span>
#include <string>

namespace maploc {

// As 2400 x 1600: a processor core then needs under 1 GB (MEASUREMENTS.md).
inline constexpr int kMaxDetectionPixels = 3'840'000;
// The detectors' own arithmetic overflows on sides beyond this: of a panorama.
inline constexpr int kMaxDetectionSidePx = 16384;

struct PixelSize {
  int width_px = 0;
  int height_px = 0;
  bool operator==(const PixelSize&) const = default;
};

// The photo's own size within both bounds; else the largest one of the same shape that is.
PixelSize DetectionSize(const PixelSize& photo);

// Pixels of the photo to one at which its features are found, 1 or more: a feature's accuracy is
// about one pixel of the reduced photo, so a threshold in pixels grows by this.
double DetectionPixel(const PixelSize& photo);

// "2 of 25 photos are large: features are found at reduced size (6000x4000 at 2400x1600) ...", of
// several sizes the largest; "" where none is reduced.
std::string DescribeReduced(std::span<const PixelSize> photos);

}  // namespace maploc
