#include "proto/recording/answer_change.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace maploc {
namespace {

bool IsLocalized(const Result<Localization>& answer) {
  return answer.ok() && answer->map_from_body.has_value();
}

double Sigma(const Localization& answer, int first) {
  return std::sqrt(answer.covariance.diagonal().segment<3>(first).sum());
}

bool IsExplained(double distance, const Localization& before, const Localization& after,
                 int first) {
  return distance <= kMovedSigmas * std::hypot(Sigma(before, first), Sigma(after, first));
}

Change ChangeOfSigma(double before, double after) {
  if (after > kNoticeable * before) return Change::kWorse;
  return before > kNoticeable * after ? Change::kBetter : Change::kSame;
}

AnswerChange CompareLocalized(const Localization& before, const Localization& after) {
  const Rigid3& from = *before.map_from_body;
  const Rigid3& to = *after.map_from_body;
  AnswerChange change;
  change.translation = (to.translation - from.translation).norm();
  change.rotation_rad = to.rotation.angularDistance(from.rotation);
  const bool is_explained = IsExplained(*change.translation, before, after, 0) &&
                            IsExplained(*change.rotation_rad, before, after, 3);
  change.change = is_explained ? ChangeOfSigma(Sigma(before, 0), Sigma(after, 0)) : Change::kMoved;
  return change;
}

}  // namespace

std::string_view ChangeName(Change change) {
  switch (change) {
    case Change::kSame:
      return "same";
    case Change::kBetter:
      return "better";
    case Change::kWorse:
      return "worse";
    case Change::kMoved:
      return "moved";
  }
  return "";
}

AnswerChange CompareAnswers(const Result<Localization>& before, const Result<Localization>& after) {
  const bool was = IsLocalized(before);
  const bool is = IsLocalized(after);
  if (was && is) return CompareLocalized(*before, *after);
  if (was == is) return {};
  return {is ? Change::kBetter : Change::kWorse, std::nullopt, std::nullopt};
}

std::optional<double> PositionSigma(const Result<Localization>& answer) {
  if (!IsLocalized(answer)) return std::nullopt;
  return Sigma(*answer, 0);
}

double ChanceOf(std::int64_t better, std::int64_t worse) {
  const double all = static_cast<double>(better + worse);
  double tail = 0.0;
  for (std::int64_t k = 0; k <= std::min(better, worse); ++k) {
    const double chosen = static_cast<double>(k);
    tail += std::exp(std::lgamma(all + 1) - std::lgamma(chosen + 1) -
                     std::lgamma(all - chosen + 1) - all * std::log(2.0));
  }
  return std::min(1.0, 2.0 * tail);
}

}  // namespace maploc
