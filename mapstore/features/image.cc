#include "mapstore/features/image.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>

#include <opencv2/imgcodecs.hpp>

#include "mapstore/base/path_kind.h"
#include "mapstore/features/image_end.h"
#include "mapstore/features/photo_header.h"

namespace maploc {
namespace {

// Reads the whole file, because a truncated picture may end with the bytes of the end mark by
// chance.
Status CheckEnd(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!EndsEarly(bytes)) return Status::Ok();
  return Status(StatusCode::kInvalidArgument, std::string(kTruncatedImage),
                path + ": is truncated: the file stops before the picture's end; copy it again");
}

std::string LastBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  std::string bytes(static_cast<std::size_t>(std::clamp<std::streamoff>(size, 0, kEndMarkBytes)),
                    '\0');
  file.seekg(-static_cast<std::streamoff>(bytes.size()), std::ios::end);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

// Sensors of 10, 12 and 14 bits are stored in the low bits of 16: the highest bit in use becomes
// the highest of 8.
void TakeUsedBits(const cv::Mat& wide, std::vector<std::uint8_t>& pixels) {
  std::uint16_t highest = 0;
  for (int y = 0; y < wide.rows; ++y) {
    const std::uint16_t* row = wide.ptr<std::uint16_t>(y);
    highest = std::max(highest, *std::max_element(row, row + wide.cols));
  }
  const int shift = std::max(0, std::bit_width(highest) - 8);
  for (int y = 0; y < wide.rows; ++y) {
    const std::uint16_t* row = wide.ptr<std::uint16_t>(y);
    std::transform(row, row + wide.cols, std::back_inserter(pixels),
                   [=](std::uint16_t value) { return static_cast<std::uint8_t>(value >> shift); });
  }
}

// OpenCV decodes no more, and its own message names neither the picture's size nor a cure.
Status CheckDecodedSize(const std::string& path) {
  constexpr std::int64_t kMaxPixels = std::int64_t{1} << 30;
  const std::optional<PhotoHeader> header = ReadPhotoHeader(path);
  if (!header || std::int64_t{header->width_px} * header->height_px <= kMaxPixels) {
    return Status::Ok();
  }
  return InvalidFile(path, "is " + std::to_string(header->width_px) + "x" +
                               std::to_string(header->height_px) +
                               " pixels, more than the 1,073,741,824 (2^30) that can be decoded; "
                               "reduce it (ImageMagick: `convert -resize 50%`) and scale its "
                               "camera alike");
}

cv::Mat Decode(const std::string& path) {
  // Orientation is ignored, because a calibration is of the stored pixels. COLMAP ignores it too.
  const int flags = cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION;
  cv::Mat decoded = cv::imread(path, flags | cv::IMREAD_ANYDEPTH);
  const bool is_known = decoded.empty() || decoded.depth() == CV_8U || decoded.depth() == CV_16U;
  return is_known ? decoded : cv::imread(path, flags);  // OpenCV's own way with floating point
}

}  // namespace

Status CheckWhole(const std::string& path) {
  if (!IsRegularFile(path) || EndsWithMark(LastBytes(path))) {
    return Status::Ok();
  }
  return CheckEnd(path);
}

Result<GrayImage> LoadGrayImage(const std::string& path) {
  if (!IsRegularFile(path)) return InvalidFile(path, "is not there");
  // OpenCV fills the missing part of a truncated JPEG with grey and only prints a warning.
  MAPLOC_RETURN_IF_ERROR(CheckEnd(path));
  MAPLOC_RETURN_IF_ERROR(CheckDecodedSize(path));
  cv::Mat decoded;
  try {
    decoded = Decode(path);
  } catch (const cv::Exception& error) {  // too many pixels, in a format that CheckDecodedSize
                                          // does not read
    return InvalidFile(path, "cannot be decoded: " + error.err);
  }
  if (decoded.empty()) return InvalidFile(path, "is not an image that OpenCV can read");
  GrayImage image{decoded.cols, decoded.rows, {}};
  image.pixels.reserve(decoded.total());
  if (decoded.depth() == CV_16U) {
    TakeUsedBits(decoded, image.pixels);
    return image;
  }
  for (int y = 0; y < decoded.rows; ++y) {
    const std::uint8_t* row = decoded.ptr<std::uint8_t>(y);
    image.pixels.insert(image.pixels.end(), row, row + decoded.cols);
  }
  return image;
}

}  // namespace maploc
