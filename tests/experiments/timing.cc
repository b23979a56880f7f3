// How long until a pose, and is it right? By matches and inlier ratio, with a stop rule.
#include <cmath>

#include "tests/experiments/experiment.h"
#include "tests/experiments/protocol.h"
#include "tests/experiments/trials.h"

namespace maploc::experiments {
namespace {

constexpr double kGravityNoiseDeg = 0.5;
constexpr int kMaxIterations = 100000;

Setting MakeSetting(int points, double inlier_ratio, int lines) {
  Setting setting;
  setting.success = Success::kClose;
  setting.keys = {
      {"experiment", "timing"}, {"noise_px", 1.0}, {"gravity_noise_deg", kGravityNoiseDeg},
      {"points", points},       {"lines", lines},  {"inlier_ratio", inlier_ratio}};
  testing::SyntheticOptions& synthetic = setting.synthetic;
  synthetic.point_inliers = static_cast<int>(std::lround(points * inlier_ratio));
  synthetic.point_outliers = points - synthetic.point_inliers;
  synthetic.line_inliers = static_cast<int>(std::lround(lines * 0.3));
  synthetic.line_outliers = lines - synthetic.line_inliers;
  synthetic.vertical_line_share = 0.9;
  synthetic.gravity_noise_rad = synthetic.gravity_sigma_rad = kGravityNoiseDeg * kDegree;
  setting.limits.max_iterations = kMaxIterations;
  return setting;
}

std::vector<Setting> Settings() {
  std::vector<Setting> settings;
  for (const int points : {300, 1000, 3000}) {
    for (const double inlier_ratio : {0.5, 0.2, 0.1, 0.05, 0.02}) {
      settings.push_back(MakeSetting(points, inlier_ratio, 0));
    }
  }
  for (const int points : {300, 1000, 3000}) settings.push_back(MakeSetting(points, 0.02, 300));
  return settings;
}

View MakeView(const std::string& name, const std::string& title, const std::string& y_key) {
  return {.name = "timing_" + name,
          .title = title,
          .panel_keys = {"points", "lines"},
          .x_key = "inlier_ratio",
          .y_key = y_key,
          .x_label = "inlier ratio of the points",
          .y_label = name,
          .log_x = true};
}

}  // namespace

Experiment TimingExperiment() {
  Experiment experiment;
  experiment.name = "timing";
  experiment.description =
      "Processor time to a pose and success within 1 degree and 0.25 m, by inlier ratio";
  experiment.example =
      "maploc-experiments timing --methods 2p-auto,opencv-magsac --only points=1000";
  experiment.default_methods = {"1p1l-auto", "2p-auto", "mixed-auto", "p3p", "opencv-magsac"};
  experiment.default_trials = 50;
  View ms = MakeView("ms", "Time to a pose, median", "median_ms");
  ms.log_y = true;
  View p99 = MakeView("p99_ms", "Time to a pose, 99th percentile", "p99_ms");
  p99.log_y = true;
  View success = MakeView("success", "Success within 1 degree and 0.25 m", "success_rate");
  success.y_is_share = true;
  experiment.views = {ms, p99, success};
  experiment.run = [](const RunOptions& options) { return RunSettings(Settings(), options); };
  return experiment;
}

}  // namespace maploc::experiments
