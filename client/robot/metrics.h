// How well a session went, against reference poses: the figures of the visual localization
// literature. Pure; thread-safe. Lengths are metres where the map is metric, else the map's unit.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/localization.h"

namespace maploc {

struct PoseError {
  double translation_m = 0.0;
  double rotation_deg = 0.0;
};

// Of an estimate against the reference, both `map_from_body`.
PoseError ErrorBetween(const Rigid3& estimated_map_from_body,
                       const Rigid3& reference_map_from_body);

// The error that an answer expects of itself: the roots of the traces of its covariance's position
// and rotation. REQUIRES: the covariance is that of a pose.
PoseError ExpectedError(const PoseCovariance& covariance);

struct RecallThreshold {
  double translation_m;
  double rotation_deg;
  std::string_view name;
};
inline constexpr std::array<RecallThreshold, 4> kRecallThresholds = {{{0.25, 2.0, "0.25m_2deg"},
                                                                      {0.5, 5.0, "0.5m_5deg"},
                                                                      {1.0, 8.0, "1m_8deg"},
                                                                      {5.0, 10.0, "5m_10deg"}}};

// An answer LOCALIZED beyond either of these is wrong.
inline constexpr double kWrongTranslationM = 1.0;
inline constexpr double kWrongRotationDeg = 10.0;

// The rotation that belongs to a translation threshold: linear in the logarithm of the translation
// through kRecallThresholds, constant outside of them.
double RotationThresholdDeg(double translation_m);

// Share of all queries whose error is at most both thresholds. An unanswered query (nullopt)
// failed. 0 without queries.
double Recall(std::span<const std::optional<PoseError>> errors, double translation_m,
              double rotation_deg);

// Area under the success curve: the mean recall over 100 translation thresholds, geometric from
// 0.05 to 5 m, each with its RotationThresholdDeg.
double AreaUnderCurve(std::span<const std::optional<PoseError>> errors);

// The q-quantile (0 <= q <= 1), linear between neighbours. nullopt without values.
std::optional<double> Quantile(std::vector<double> values, double q);

struct Metrics {
  int queries = 0;
  int localized = 0;
  int wrong = 0;
  std::optional<double> median_translation_error_m;  // of localized queries
  std::optional<double> median_rotation_error_deg;
  std::array<double, 4> recall{};  // at kRecallThresholds, of all queries
  double auc = 0.0;
};

// One entry a query: its error where it was LOCALIZED, else nullopt.
Metrics Summarize(std::span<const std::optional<PoseError>> errors);

}  // namespace maploc
