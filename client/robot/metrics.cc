#include "client/robot/metrics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace maploc {
namespace {

constexpr int kCurveThresholds = 100;
constexpr double kCurveFirstM = 0.05;
constexpr double kCurveLastM = 5.0;

bool IsWrong(const PoseError& error) {
  return error.translation_m > kWrongTranslationM || error.rotation_deg > kWrongRotationDeg;
}

}  // namespace

PoseError ErrorBetween(const Rigid3& estimated_map_from_body,
                       const Rigid3& reference_map_from_body) {
  return {(estimated_map_from_body.translation - reference_map_from_body.translation).norm(),
          RotationAngleBetween(estimated_map_from_body.rotation, reference_map_from_body.rotation) *
              180.0 / std::numbers::pi};
}

PoseError ExpectedError(const PoseCovariance& covariance) {
  const double position = covariance.topLeftCorner<3, 3>().trace();
  const double rotation = covariance.bottomRightCorner<3, 3>().trace();
  return {std::sqrt(position), std::sqrt(rotation) * 180.0 / std::numbers::pi};
}

double RotationThresholdDeg(double translation_m) {
  const auto& pairs = kRecallThresholds;
  if (translation_m <= pairs.front().translation_m) return pairs.front().rotation_deg;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    if (translation_m > pairs[i].translation_m) continue;
    const double share = std::log(translation_m / pairs[i - 1].translation_m) /
                         std::log(pairs[i].translation_m / pairs[i - 1].translation_m);
    return std::lerp(pairs[i - 1].rotation_deg, pairs[i].rotation_deg, share);
  }
  return pairs.back().rotation_deg;
}

double Recall(std::span<const std::optional<PoseError>> errors, double translation_m,
              double rotation_deg) {
  if (errors.empty()) return 0.0;
  // A share of all queries: else a robot that answers only the easy ones would look better.
  const auto good = std::ranges::count_if(errors, [&](const std::optional<PoseError>& error) {
    return error && error->translation_m <= translation_m && error->rotation_deg <= rotation_deg;
  });
  return static_cast<double>(good) / static_cast<double>(errors.size());
}

double AreaUnderCurve(std::span<const std::optional<PoseError>> errors) {
  double sum = 0.0;
  for (int i = 0; i < kCurveThresholds; ++i) {
    const double translation_m =
        kCurveFirstM *
        std::pow(kCurveLastM / kCurveFirstM, static_cast<double>(i) / (kCurveThresholds - 1));
    sum += Recall(errors, translation_m, RotationThresholdDeg(translation_m));
  }
  return sum / kCurveThresholds;
}

std::optional<double> Quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nullopt;
  std::ranges::sort(values);
  const double position = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], position - static_cast<double>(below));
}

Metrics Summarize(std::span<const std::optional<PoseError>> errors) {
  Metrics metrics;
  metrics.queries = static_cast<int>(errors.size());
  std::vector<double> translations_m;
  std::vector<double> rotations_deg;
  for (const std::optional<PoseError>& error : errors) {
    // An unanswered query has no error, so the medians are those of the answers alone.
    if (!error) continue;
    ++metrics.localized;
    metrics.wrong += IsWrong(*error) ? 1 : 0;
    translations_m.push_back(error->translation_m);
    rotations_deg.push_back(error->rotation_deg);
  }
  metrics.median_translation_error_m = Quantile(translations_m, 0.5);
  metrics.median_rotation_error_deg = Quantile(rotations_deg, 0.5);
  for (std::size_t i = 0; i < kRecallThresholds.size(); ++i) {
    metrics.recall[i] =
        Recall(errors, kRecallThresholds[i].translation_m, kRecallThresholds[i].rotation_deg);
  }
  metrics.auc = AreaUnderCurve(errors);
  return metrics;
}

}  // namespace maploc
