// Grey images as plain values, so that OpenCV's headers stay inside this folder.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapstore/base/status.h"

namespace maploc {

// 8 bits a pixel, row-major without padding.
struct GrayImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> pixels;  // width_px * height_px
};

// Any format OpenCV reads, as stored (an orientation tag is ignored: calibrations are of the stored
// pixels). Error: names the file.
Result<GrayImage> LoadGrayImage(const std::string& path);

}  // namespace maploc
