// A GrayImage seen as OpenCV's matrix. Only for the .cc files of this folder.
#pragma once

#include <opencv2/core.hpp>

#include "mapstore/base/status.h"
#include "mapstore/features/image.h"

namespace maploc {

// The detectors' own arithmetic overflows on sides beyond this.
inline constexpr int kMaxDetectionSidePx = 16384;
// Below this a detector finds nothing: neither a descriptor's surroundings nor a line fit.
inline constexpr int kMinDetectionSidePx = 32;

// Shares the pixels: the view must not outlive `image` and must not be written to. Error:
// INVALID_ARGUMENT when sides and pixels disagree or a side is beyond kMaxDetectionSidePx.
inline Result<cv::Mat> ViewAsMat(const GrayImage& image) {
  const auto bad_side = [](int side) { return side < 1 || side > kMaxDetectionSidePx; };
  if (bad_side(image.width_px) || bad_side(image.height_px)) {
    return InvalidArgument("image", "its sides must be in [1, 16384] pixels");
  }
  const std::size_t expected = static_cast<std::size_t>(image.width_px) * image.height_px;
  if (image.pixels.size() != expected) {
    return InvalidArgument("image.pixels", "their count is not width times height");
  }
  return cv::Mat(image.height_px, image.width_px, CV_8UC1,
                 const_cast<std::uint8_t*>(image.pixels.data()));
}

}  // namespace maploc
