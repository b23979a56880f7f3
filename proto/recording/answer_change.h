// What has become of a query between two answers: of two versions of a map, of two strategies, or
// then and now. Pure; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"

namespace maploc {

enum class Change {
  kSame,
  kBetter,  // localized now and not before, or with smaller sigmas
  kWorse,   // the other way round
  kMoved,   // localized both times, at places that their sigmas do not explain: one is wrong
};

std::string_view ChangeName(Change change);  // "same", "better", "worse", "moved"

// Both poses differ by more than so many sigmas of both together: moved.
inline constexpr double kMovedSigmas = 3.0;
// A position's sigma that grew to so many times of what it was is worse, one that shrank by as
// much better. So little, because a map that lost a quarter of its photos may localize as many
// queries, each a little less surely (MEASUREMENTS.md); whether that is chance the verdict says.
inline constexpr double kNoticeable = 1.05;

struct AnswerChange {
  Change change = Change::kSame;
  // Between the two poses, where there are two: map unit, and radians.
  std::optional<double> translation;
  std::optional<double> rotation_rad;
};

// REQUIRES: poses in the same map frame.
AnswerChange CompareAnswers(const Result<Localization>& before, const Result<Localization>& after);

// Root of the trace of the position's covariance, map unit; none without a pose.
std::optional<double> PositionSigma(const Result<Localization>& answer);

// The probability that of `better + worse` fair coins as many or more fall on the side that
// prevails (sign test, both sides); 1 where none does.
double ChanceOf(std::int64_t better, std::int64_t worse);

}  // namespace maploc
