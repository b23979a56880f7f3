#include "mapstore/features/image.h"

#include <filesystem>

#include <opencv2/imgcodecs.hpp>

namespace maploc {

Result<GrayImage> LoadGrayImage(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) return InvalidFile(path, "is not there");
  cv::Mat decoded;
  try {
    decoded = cv::imread(path, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {  // OpenCV's bound on an image's pixels
    return InvalidFile(path, "cannot be decoded: " + error.err);
  }
  if (decoded.empty()) return InvalidFile(path, "is not an image that OpenCV can read");
  GrayImage image{decoded.cols, decoded.rows, {}};
  image.pixels.reserve(decoded.total());
  for (int y = 0; y < decoded.rows; ++y) {
    const std::uint8_t* row = decoded.ptr<std::uint8_t>(y);
    image.pixels.insert(image.pixels.end(), row, row + decoded.cols);
  }
  return image;
}

}  // namespace maploc
