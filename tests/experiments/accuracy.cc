// How exact is a pose? Median errors by pixel noise, gravity noise and matches; no outliers.
#include <algorithm>

#include "tests/experiments/experiment.h"
#include "tests/experiments/protocol.h"
#include "tests/experiments/refinement_comparison.h"
#include "tests/experiments/trials.h"

namespace maploc::experiments {
namespace {

std::vector<Setting> Settings() {
  std::vector<Setting> settings;
  for (const double gravity_noise_deg : {0.0, 0.5, 1.0, 2.0}) {
    for (const int inliers : {10, 5, 4, 3}) {
      for (const double noise_px : {0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0}) {
        settings.push_back(
            PaperSetting("accuracy", {.inliers = inliers,
                                      .noise_px = noise_px,
                                      .gravity_noise_deg = gravity_noise_deg,
                                      .threshold_px = 3.0 * std::max(1.0, noise_px)}));
      }
    }
  }
  return settings;
}

View MakeView(const std::string& what, const std::string& y_key, const std::string& y_label) {
  return {.name = "accuracy_" + what,
          .title = "Accuracy: median " + what + " error",
          .panel_keys = {"inliers", "gravity_noise_deg"},
          .x_key = "noise_px",
          .y_key = y_key,
          .x_label = "noise (px)",
          .y_label = y_label};
}

}  // namespace

Experiment AccuracyExperiment() {
  Experiment experiment;
  experiment.name = "accuracy";
  experiment.description = "Median errors by pixel noise, gravity noise and matches; no outliers";
  experiment.example =
      "maploc-experiments accuracy --methods mixed-4dof,mixed-6dof,mixed-auto --trials 2000";
  experiment.default_methods = AllMethodNames();
  experiment.views = {
      MakeView("rotation", "median_rotation_error_deg", "rotation error (degrees)"),
      MakeView("translation", "median_translation_error_percent", "translation error (%)")};
  experiment.run = [](const RunOptions& options) -> Result<Rows> {
    MAPLOC_ASSIGN_OR_RETURN(Rows rows, RunSettings(Settings(), options));
    return WithRefinementComparison(std::move(rows));
  };
  return experiment;
}

}  // namespace maploc::experiments
