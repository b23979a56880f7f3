#include <algorithm>
#include <cmath>
#include <numeric>

#include <opencv2/features2d.hpp>

#include "mapstore/features/features.h"
#include "mapstore/features/opencv_image.h"

namespace maploc {
namespace {

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

PointFeatures DetectOrb(const cv::Mat& image, const DescriptorKind& kind, int max_features) {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::ORB::create(max_features)->detectAndCompute(image, cv::noArray(), keypoints, descriptors);
  PointFeatures features;
  features.descriptors.kind = kind;
  for (const int i : StrongestFirst(keypoints)) {
    const cv::Point2f& p = keypoints[static_cast<std::size_t>(i)].pt;
    features.keypoints_px.emplace_back(p.x, p.y);
    const std::uint8_t* row = descriptors.ptr<std::uint8_t>(i);
    features.descriptors.bytes.insert(features.descriptors.bytes.end(), row, row + kind.bytes);
  }
  return features;
}

PointFeatures DetectSift(const cv::Mat& image, const DescriptorKind& kind, int max_features) {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::SIFT::create(max_features)->detectAndCompute(image, cv::noArray(), keypoints, descriptors);
  PointFeatures features;
  features.descriptors.kind = kind;
  for (const int i : StrongestFirst(keypoints)) {
    const cv::Point2f& p = keypoints[static_cast<std::size_t>(i)].pt;
    features.keypoints_px.emplace_back(p.x, p.y);
    const float* row = descriptors.ptr<float>(i);
    if (kind.name == "sift_root_u8") {
      AppendRootSift(row, features.descriptors.bytes);
    } else {
      for (int k = 0; k < kind.bytes; ++k) {
        features.descriptors.bytes.push_back(cv::saturate_cast<std::uint8_t>(row[k]));
      }
    }
  }
  return features;
}

}  // namespace

Result<PointFeatures> DetectPoints(const GrayImage& image, const DescriptorKind& kind,
                                   const PointDetectionOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(const cv::Mat view, ViewAsMat(image));
  if (options.max_features < 1) return InvalidArgument("max_features", "must be positive");
  const bool is_sift = kind.name == "sift_root_u8" || kind.name == "sift_u8";
  if (!is_sift && kind.name != "orb") {
    return Status(StatusCode::kUnimplemented, "NO_DETECTOR",
                  "descriptors of kind '" + kind.name +
                      "' cannot be extracted from photos; use orb, sift_root_u8 or sift_u8, or "
                      "take the features from a database");
  }
  try {
    return is_sift ? DetectSift(view, kind, options.max_features)
                   : DetectOrb(view, kind, options.max_features);
  } catch (const cv::Exception& error) {
    return Internal("keypoint detection failed: " + error.err);
  }
}

}  // namespace maploc
