// A GrayImage seen as OpenCV's matrix. Only for the .cc files of this folder.
#pragma once

#include <opencv2/core.hpp>

#include "mapstore/base/status.h"
#include "mapstore/features/image.h"

namespace maploc {

// Below this a detector finds nothing: neither a descriptor's surroundings nor a line fit.
inline constexpr int kMinDetectionSidePx = 32;

// Shares the pixels: the view must not outlive `image` and must not be written to. Error:
// INVALID_ARGUMENT when sides and pixels disagree.
inline Result<cv::Mat> ViewAsMat(const GrayImage& image) {
  if (image.width_px < 1 || image.height_px < 1) {
    return InvalidArgument("image", "its sides must be at least 1 pixel");
  }
  const std::size_t expected = static_cast<std::size_t>(image.width_px) * image.height_px;
  if (image.pixels.size() != expected) {
    return InvalidArgument("image.pixels", "their count is not width times height");
  }
  return cv::Mat(image.height_px, image.width_px, CV_8UC1,
                 const_cast<std::uint8_t*>(image.pixels.data()));
}

}  // namespace maploc
