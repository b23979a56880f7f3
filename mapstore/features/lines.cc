#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>
#include <opencv2/line_descriptor.hpp>

#include "mapstore/features/features.h"
#include "mapstore/features/opencv_image.h"
#include "mapstore/features/reduced_photo.h"

namespace maploc {
namespace {

float Length(const cv::Vec4f& s) { return std::hypot(s[2] - s[0], s[3] - s[1]); }

// LSD works on the image reduced to 0.8, which puts pixel x at 0.8 x - 0.1, and then divides by 0.8
// alone: an eighth of a pixel is missing (measured: README.md).
constexpr float kLsdShiftPx = 0.125f;

std::vector<cv::Vec4f> DetectSegments(const cv::Mat& image) {
  std::vector<cv::Vec4f> segments;
  cv::createLineSegmentDetector(cv::LSD_REFINE_STD)->detect(image, segments);
  // LBD reads the pixels around a segment, so segments must not leave the image.
  const auto limit_x = static_cast<float>(image.cols - 1);
  const auto limit_y = static_cast<float>(image.rows - 1);
  for (cv::Vec4f& s : segments) {
    for (int i = 0; i < 4; ++i)
      s[i] = std::clamp(s[i] + kLsdShiftPx, 0.0f, i % 2 == 0 ? limit_x : limit_y);
  }
  constexpr auto kMinLength = static_cast<float>(kMinLineLengthPx);
  std::erase_if(segments, [](const cv::Vec4f& s) { return !(Length(s) >= kMinLength); });
  // Segments of equal length keep the detector's order, so that every run gives the same ones.
  std::stable_sort(segments.begin(), segments.end(),
                   [](const cv::Vec4f& a, const cv::Vec4f& b) { return Length(a) > Length(b); });
  if (segments.size() > std::size_t{kMaxLines}) segments.resize(kMaxLines);
  return segments;
}

cv::line_descriptor::KeyLine MakeKeyLine(const cv::Vec4f& s, int id, const cv::Mat& image) {
  cv::line_descriptor::KeyLine line;
  // There is one octave, so positions in it are positions in the image.
  line.startPointX = line.sPointInOctaveX = s[0];
  line.startPointY = line.sPointInOctaveY = s[1];
  line.endPointX = line.ePointInOctaveX = s[2];
  line.endPointY = line.ePointInOctaveY = s[3];
  line.lineLength = Length(s);
  line.angle = std::atan2(s[3] - s[1], s[2] - s[0]);
  line.class_id = id;
  line.octave = 0;
  line.size = (s[2] - s[0]) * (s[3] - s[1]);
  line.response = line.lineLength / static_cast<float>(std::max(image.cols, image.rows));
  line.numOfPixels =
      cv::LineIterator(image, cv::Point2f(s[0], s[1]), cv::Point2f(s[2], s[3])).count;
  line.pt = cv::Point2f((s[0] + s[2]) / 2, (s[1] + s[3]) / 2);
  return line;
}

LineFeatures Describe(const cv::Mat& image, const std::vector<cv::Vec4f>& segments,
                      const DescriptorKind& kind) {
  std::vector<cv::line_descriptor::KeyLine> lines;
  for (const cv::Vec4f& s : segments) {
    lines.push_back(MakeKeyLine(s, static_cast<int>(lines.size()), image));
  }
  cv::Mat descriptors;
  cv::line_descriptor::BinaryDescriptor::createBinaryDescriptor()->compute(image, lines,
                                                                           descriptors);
  LineFeatures features;
  features.descriptors.kind = kind;
  for (const cv::line_descriptor::KeyLine& line : lines) {
    features.starts_px.emplace_back(line.startPointX, line.startPointY);
    features.ends_px.emplace_back(line.endPointX, line.endPointY);
    const std::uint8_t* row = descriptors.ptr<std::uint8_t>(static_cast<int>(&line - lines.data()));
    features.descriptors.bytes.insert(features.descriptors.bytes.end(), row, row + kind.bytes);
  }
  return features;
}

}  // namespace

Result<LineFeatures> DetectLines(const GrayImage& image) {
  MAPLOC_ASSIGN_OR_RETURN(const ReducedPhoto photo, ReduceForDetection(image));
  MAPLOC_ASSIGN_OR_RETURN(const DescriptorKind kind, DescriptorKindFromName("lbd"));
  LineFeatures none;
  none.descriptors.kind = kind;
  if (std::min(photo.pixels.cols, photo.pixels.rows) < kMinDetectionSidePx) return none;
  try {
    const std::vector<cv::Vec4f> segments = DetectSegments(photo.pixels);
    if (segments.empty()) return none;
    LineFeatures lines = Describe(photo.pixels, segments, kind);
    photo.ToPhoto(lines.starts_px);
    photo.ToPhoto(lines.ends_px);
    return lines;
  } catch (const cv::Exception& error) {
    return Internal("line detection failed: " + error.err);
  }
}

}  // namespace maploc
