#include "tests/experiments/protocol.h"

#include <algorithm>
#include <cmath>

namespace maploc::experiments {
namespace {

constexpr int kIterations = 100;
constexpr double kLeastPixelSigma = 0.1;  // no detector is exact

}  // namespace

Setting PaperSetting(const std::string& experiment, const PaperCell& cell) {
  Setting setting;
  setting.keys = {{"experiment", experiment},
                  {"inliers", cell.inliers},
                  {"outlier_rate", cell.outlier_rate},
                  {"noise_px", cell.noise_px},
                  {"gravity_noise_deg", cell.gravity_noise_deg}};
  const int outliers =
      static_cast<int>(std::lround(cell.inliers * cell.outlier_rate / (1.0 - cell.outlier_rate)));
  testing::SyntheticOptions& synthetic = setting.synthetic;
  synthetic.point_inliers = synthetic.line_inliers = cell.inliers;
  synthetic.point_outliers = synthetic.line_outliers = outliers;
  synthetic.outliers = testing::Outliers::kWrongAssociations;
  synthetic.noise_px = cell.noise_px;
  synthetic.gravity_noise_rad = cell.gravity_noise_deg * kDegree;
  synthetic.gravity_sigma_rad = std::max(cell.gravity_noise_deg * kDegree, kLeastGravitySigmaRad);
  setting.limits.threshold_px = cell.threshold_px;
  setting.limits.pixel_sigma = std::max(cell.noise_px, kLeastPixelSigma);
  setting.limits.min_iterations = setting.limits.max_iterations = kIterations;
  return setting;
}

}  // namespace maploc::experiments
