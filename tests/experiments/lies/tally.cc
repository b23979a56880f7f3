#include "tests/experiments/lies/tally.h"

#include <cmath>
#include <numbers>

#include "tests/experiments/trials.h"

namespace maploc::lies {

Answered Compare(const Localization& answer, const HonestQuery& honest, bool metric) {
  Answered compared;
  if (!answer.map_from_body) return compared;
  compared.localized = true;
  const Rigid3& truth = honest.map_from_camera;
  compared.translation = (answer.map_from_body->translation - truth.translation).norm();
  compared.relative = compared.translation / honest.median_depth;
  compared.rotation_deg =
      RotationAngleBetween(answer.map_from_body->rotation, truth.rotation) * 180 / std::numbers::pi;
  compared.sigmas =
      compared.translation / std::sqrt(answer.covariance.topLeftCorner<3, 3>().trace());
  compared.off = metric ? compared.translation > 0.25 || compared.rotation_deg > 5
                        : compared.relative > 0.02 || compared.rotation_deg > 2;
  compared.wrong = metric ? compared.translation > 1 || compared.rotation_deg > 10
                          : compared.relative > 0.05 || compared.rotation_deg > 5;
  return compared;
}

void Tally::Add(const Localization& answer, const Answered& compared) {
  ++queries_;
  ++outcomes_[answer.outcome];
  server_ms_.push_back(answer.times.ransac_ms + answer.times.refinement_ms);
  if (!compared.localized) return;
  ++localized_;
  off_ += compared.off ? 1 : 0;
  right_ += compared.off ? 0 : 1;
  wrong_ += compared.wrong ? 1 : 0;
  gravity_rejected_ += answer.evidence.gravity_rejected ? 1 : 0;
  translations_.push_back(compared.translation);
  relatives_.push_back(compared.relative);
  rotations_deg_.push_back(compared.rotation_deg);
  sigmas_.push_back(compared.sigmas);
}

experiments::Row Tally::ToRow(const std::string& set, const Lie& lie) const {
  const auto count = [&](Outcome outcome) {
    const auto found = outcomes_.find(outcome);
    return found == outcomes_.end() ? 0 : found->second;
  };
  experiments::Row row = {{"experiment", "lies"},
                          {"set", set},
                          {"family", lie.family},
                          {"lie", lie.name},
                          {"queries", queries_},
                          {"localized", localized_},
                          {"right", right_},
                          {"off", off_},
                          {"wrong", wrong_},
                          {"gravity_rejected", gravity_rejected_},
                          {"gravity_inconsistent", count(Outcome::kGravityInconsistent)},
                          {"low_confidence", count(Outcome::kLowConfidence)}};
  const auto quantile = [&](const char* key, const std::vector<double>& values, double p) {
    if (!values.empty()) row[key] = experiments::Quantile(values, p);
  };
  quantile("median_translation", translations_, 0.5);
  quantile("median_depth_percent", relatives_, 0.5);
  if (row.contains("median_depth_percent")) {
    row["median_depth_percent"] = 100 * row["median_depth_percent"].get<double>();
  }
  quantile("median_rotation_deg", rotations_deg_, 0.5);
  quantile("worst_translation", translations_, 1.0);
  quantile("median_sigmas", sigmas_, 0.5);
  quantile("p95_sigmas", sigmas_, 0.95);
  quantile("p99_sigmas", sigmas_, 0.99);
  quantile("worst_sigmas", sigmas_, 1.0);
  quantile("median_estimator_ms", server_ms_, 0.5);
  return row;
}

}  // namespace maploc::lies
