// Grey images as plain values, so that OpenCV's headers stay inside this folder.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mapstore/base/status.h"

namespace maploc {

// 8 bits a pixel, row-major without padding.
struct GrayImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> pixels;  // width_px * height_px
};

// The reason of an error that means a JPEG or PNG without its end.
inline constexpr std::string_view kTruncatedImage = "TRUNCATED_IMAGE";

// TRUNCATED_IMAGE, naming the file, for a JPEG or PNG that LoadGrayImage would refuse as cut.
// Cheap: of a file that ends with an end mark no more than that is read. Ok where nothing is seen.
Status CheckWhole(const std::string& path);

// Any format OpenCV reads, as stored (an orientation tag is ignored: calibrations are of the stored
// pixels). Of 16 bits a pixel the eight below the highest one in use are taken. Error: names the
// file.
Result<GrayImage> LoadGrayImage(const std::string& path);

}  // namespace maploc
