// How many outliers does a method bear? The paper's figure of robustness.
#include "tests/experiments/experiment.h"
#include "tests/experiments/protocol.h"
#include "tests/experiments/trials.h"

namespace maploc::experiments {
namespace {

std::vector<Setting> Settings() {
  std::vector<Setting> settings;
  for (const double gravity_noise_deg : {0.0, 1.0}) {
    for (const int inliers : {10, 5, 4, 3}) {
      for (int tenths = 0; tenths <= 8; ++tenths) {
        settings.push_back(PaperSetting("robustness", {.inliers = inliers,
                                                       .outlier_rate = tenths / 10.0,
                                                       .gravity_noise_deg = gravity_noise_deg}));
      }
    }
  }
  return settings;
}

}  // namespace

Experiment RobustnessExperiment() {
  Experiment experiment;
  experiment.name = "robustness";
  experiment.description = "Success by outlier rate, inliers and gravity noise; 100 iterations";
  experiment.example =
      "maploc-experiments robustness --methods mixed-auto,p3p --only outlier_rate=0.8 --trials "
      "1000";
  experiment.default_methods = AllMethodNames();
  experiment.views = {{.name = "robustness",
                       .title = "Robustness: success within 5 degrees and 10%",
                       .panel_keys = {"inliers", "gravity_noise_deg"},
                       .x_key = "outlier_rate",
                       .y_key = "success_rate",
                       .x_label = "outlier rate",
                       .y_label = "success rate",
                       .y_is_share = true}};
  experiment.run = [](const RunOptions& options) { return RunSettings(Settings(), options); };
  return experiment;
}

}  // namespace maploc::experiments
