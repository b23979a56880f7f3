// A photo as a detector gets it: reduced where it is large, and the way back to the photo's pixels.
// Only for the .cc files of this folder.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "mapstore/base/status.h"
#include "mapstore/features/image.h"

namespace maploc {

struct ReducedPhoto {
  cv::Mat pixels;  // of a photo that is not reduced a view, which must not outlive the image
  cv::Size photo;  // the photo's own size

  // From positions in `pixels` to positions in the photo. The pixels' outer borders stay in place:
  // (x + 1/2) / side = (x_reduced + 1/2) / side_reduced. A photo that is not reduced keeps its
  // bits.
  void ToPhoto(std::vector<Eigen::Vector2f>& positions_px) const;
};

// To DetectionSize, each pixel the mean of those it covers. Error: as ViewAsMat's.
Result<ReducedPhoto> ReduceForDetection(const GrayImage& image);

}  // namespace maploc
