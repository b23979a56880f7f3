#include "mapstore/features/reduced_photo.h"

#include <opencv2/imgproc.hpp>

#include "mapstore/features/detection_size.h"
#include "mapstore/features/opencv_image.h"

namespace maploc {

void ReducedPhoto::ToPhoto(std::vector<Eigen::Vector2f>& positions_px) const {
  if (pixels.size() == photo) return;
  const Eigen::Array2d scale(static_cast<double>(photo.width) / pixels.cols,
                             static_cast<double>(photo.height) / pixels.rows);
  for (Eigen::Vector2f& position : positions_px) {
    position = ((position.cast<double>().array() + 0.5) * scale - 0.5).cast<float>();
  }
}

Result<ReducedPhoto> ReduceForDetection(const GrayImage& image) {
  MAPLOC_ASSIGN_OR_RETURN(const cv::Mat view, ViewAsMat(image));
  const PixelSize size = DetectionSize({view.cols, view.rows});
  ReducedPhoto photo{view, view.size()};
  if (cv::Size(size.width_px, size.height_px) == view.size()) return photo;
  photo.pixels = cv::Mat();
  try {
    cv::resize(view, photo.pixels, {size.width_px, size.height_px}, 0, 0, cv::INTER_AREA);
  } catch (const cv::Exception& error) {
    return Internal("reducing a photo failed: " + error.err);
  }
  return photo;
}

}  // namespace maploc
