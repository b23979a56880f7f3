#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include <opencv2/features2d.hpp>

#include "mapstore/features/features.h"
#include "mapstore/features/opencv_image.h"
#include "mapstore/features/reduced_photo.h"

namespace maploc {
namespace {

constexpr float kOrbScaleFactor = 1.2f;  // OpenCV's default
constexpr int kSiftOctaveLayers = 3;
// COLMAP's peak threshold 0.02 / 3 in OpenCV's terms: half of OpenCV's default, so that a wall with
// little contrast has keypoints too. The strongest are kept anyway.
constexpr double kSiftContrastThreshold = 0.02;
// SIFT doubles the image first, which puts pixel x at 2x + 1/2, and halves the result without
// undoing that half (measured: README.md).
constexpr float kSiftShiftPx = 0.25f;

// Strongest first; equal responses keep the detector's order, so that the result is one and the
// same on every run.
std::vector<int> StrongestFirst(const std::vector<cv::KeyPoint>& keypoints) {
  std::vector<int> order(keypoints.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return keypoints[static_cast<std::size_t>(a)].response >
           keypoints[static_cast<std::size_t>(b)].response;
  });
  return order;
}

// COLMAP's normalization: L1, square root, times 512.
void AppendRootSift(const float* values, std::vector<std::uint8_t>& bytes) {
  constexpr int kSize = 128;
  const float sum = std::accumulate(values, values + kSize, 0.0f);
  for (int i = 0; i < kSize; ++i) {
    const float root = sum > 0 ? std::sqrt(values[i] / sum) : 0.0f;
    bytes.push_back(static_cast<std::uint8_t>(std::min(std::round(512.0f * root), 255.0f)));
  }
}

struct Detection {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;  // one row a keypoint
};

// ORB multiplies a pyramid level's coordinates by its nominal scale. But levels are resized with
// the pixels' outer borders in place, to whole sizes: (x_level + 1/2) / side_level = (x + 1/2) /
// side.
Eigen::Vector2f OrbPosition(const cv::KeyPoint& keypoint, const cv::Size& size) {
  const auto scale =
      static_cast<float>(std::pow(static_cast<double>(kOrbScaleFactor), keypoint.octave));
  const auto undo = [scale](float position, int side) {
    const auto side_level = static_cast<float>(cvRound(static_cast<float>(side) / scale));
    return (position / scale + 0.5f) * static_cast<float>(side) / side_level - 0.5f;
  };
  return {undo(keypoint.pt.x, size.width), undo(keypoint.pt.y, size.height)};
}

PointFeatures DetectOrb(const cv::Mat& image, const DescriptorKind& kind, int max_features) {
  Detection found;
  cv::ORB::create(max_features, kOrbScaleFactor)
      ->detectAndCompute(image, cv::noArray(), found.keypoints, found.descriptors);
  PointFeatures features;
  features.descriptors.kind = kind;
  for (const int i : StrongestFirst(found.keypoints)) {
    features.keypoints_px.push_back(
        OrbPosition(found.keypoints[static_cast<std::size_t>(i)], image.size()));
    const std::uint8_t* row = found.descriptors.ptr<std::uint8_t>(i);
    features.descriptors.bytes.insert(features.descriptors.bytes.end(), row, row + kind.bytes);
  }
  return features;
}

PointFeatures DetectSift(const cv::Mat& image, const DescriptorKind& kind, int max_features) {
  Detection found;
  cv::SIFT::create(max_features, kSiftOctaveLayers, kSiftContrastThreshold)
      ->detectAndCompute(image, cv::noArray(), found.keypoints, found.descriptors);
  PointFeatures features;
  features.descriptors.kind = kind;
  for (const int i : StrongestFirst(found.keypoints)) {
    const cv::Point2f& p = found.keypoints[static_cast<std::size_t>(i)].pt;
    features.keypoints_px.emplace_back(p.x - kSiftShiftPx, p.y - kSiftShiftPx);
    const float* row = found.descriptors.ptr<float>(i);
    if (kind.name == "sift_root_u8") {
      AppendRootSift(row, features.descriptors.bytes);
    } else {
      std::transform(row, row + kind.bytes, std::back_inserter(features.descriptors.bytes),
                     [](float value) { return cv::saturate_cast<std::uint8_t>(value); });
    }
  }
  return features;
}

}  // namespace

Result<PointFeatures> DetectPoints(const GrayImage& image, const DescriptorKind& kind,
                                   const PointDetectionOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(const ReducedPhoto photo, ReduceForDetection(image));
  if (options.max_features < 1) return InvalidArgument("max_features", "must be positive");
  const bool is_sift = kind.name == "sift_root_u8" || kind.name == "sift_u8";
  if (!is_sift && kind.name != "orb") {
    return Status(StatusCode::kUnimplemented, "NO_DETECTOR",
                  "descriptors of kind '" + kind.name +
                      "' cannot be extracted from photos; use orb, sift_root_u8 or sift_u8, or "
                      "take the features from a database");
  }
  // OpenCV fails on images that have no room for a pyramid; no keypoint's surroundings fit there.
  if (std::min(photo.pixels.cols, photo.pixels.rows) < kMinDetectionSidePx) {
    PointFeatures none;
    none.descriptors.kind = kind;
    return none;
  }
  try {
    PointFeatures points = is_sift ? DetectSift(photo.pixels, kind, options.max_features)
                                   : DetectOrb(photo.pixels, kind, options.max_features);
    photo.ToPhoto(points.keypoints_px);
    return points;
  } catch (const cv::Exception& error) {
    return Internal("keypoint detection failed: " + error.err);
  }
}

}  // namespace maploc
