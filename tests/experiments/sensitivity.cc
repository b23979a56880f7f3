// How wrong may pitch and roll be? The paper's figure of sensitivity.
#include "tests/experiments/experiment.h"
#include "tests/experiments/protocol.h"
#include "tests/experiments/trials.h"

namespace maploc::experiments {
namespace {

std::vector<Setting> Settings() {
  std::vector<Setting> settings;
  for (const int inliers : {10, 5, 3}) {
    for (const double gravity_noise_deg : {0.0, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 25.0}) {
      settings.push_back(PaperSetting(
          "sensitivity",
          {.inliers = inliers, .gravity_noise_deg = gravity_noise_deg, .threshold_px = 12.0}));
    }
  }
  return settings;
}

View MakeView(const std::string& name, const std::string& title, const std::string& y_key) {
  return {.name = "sensitivity_" + name,
          .title = "Sensitivity: " + title,
          .panel_keys = {"inliers"},
          .x_key = "gravity_noise_deg",
          .y_key = y_key,
          .x_label = "noise of pitch and roll (degrees)",
          .y_label = title};
}

}  // namespace

Experiment SensitivityExperiment() {
  Experiment experiment;
  experiment.name = "sensitivity";
  experiment.description = "Errors and success by the noise of pitch and roll; 12 px threshold";
  experiment.example = "maploc-experiments sensitivity --methods mixed-4dof,mixed-auto --plot .";
  experiment.default_methods = {"1p1l-4dof", "1p1l-6dof",  "1p1l-auto",  "2p-4dof",   "2p-6dof",
                                "2p-auto",   "mixed-4dof", "mixed-6dof", "mixed-auto"};
  View success = MakeView("success", "success within 5 degrees and 10%", "success_rate");
  success.y_is_share = true;
  experiment.views = {
      success, MakeView("rotation", "median rotation error (degrees)", "median_rotation_error_deg"),
      MakeView("translation", "median translation error (%)", "median_translation_error_percent")};
  experiment.run = [](const RunOptions& options) { return RunSettings(Settings(), options); };
  return experiment;
}

}  // namespace maploc::experiments
