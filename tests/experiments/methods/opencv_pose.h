// OpenCV's way of telling a pose.
#pragma once

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "mapstore/geometry/rigid3.h"

namespace maploc::experiments {

// From a rotation vector and a translation.
inline Rigid3 ToRigid3(const cv::Mat& turn, const cv::Mat& translation) {
  const cv::Vec3d w(turn), t(translation);
  const Eigen::Vector3d axis(w[0], w[1], w[2]);
  Rigid3 pose;
  if (axis.norm() > 0) pose.rotation = Eigen::AngleAxisd(axis.norm(), axis.normalized());
  pose.translation = {t[0], t[1], t[2]};
  return pose;
}

}  // namespace maploc::experiments
