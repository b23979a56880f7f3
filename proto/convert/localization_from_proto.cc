#include <cmath>
#include <optional>
#include <utility>

#include "maploc/v1/localization_service.pb.h"
#include "proto/convert/checks.h"
#include "proto/convert/convert.h"

namespace maploc {
namespace {

Result<FeatureCounts> CountsFromProto(const v1::FeatureCounts& counts, const char* field) {
  if (counts.inlier_count() < 0 || counts.inlier_count() > counts.match_count()) {
    return InvalidArgument(field, "needs 0 <= inlier_count <= match_count", "OUT_OF_RANGE");
  }
  return FeatureCounts{counts.match_count(), counts.inlier_count()};
}

StageTimes TimesFromProto(const v1::StageTimes& times) {
  return {times.convert_ms(), times.retrieval_ms(),  times.matching_ms(),
          times.ransac_ms(),  times.refinement_ms(), times.total_ms()};
}

Status MatchesFromProto(const v1::FeatureMatches& proto, const std::string& field,
                        std::vector<FeatureMatch>* matches, std::vector<std::uint8_t>* inliers) {
  const auto count = static_cast<std::size_t>(proto.feature_indices_size());
  if (proto.inliers().size() != count) {
    return InvalidArgument(field + ".inliers", "their count differs from the indices'",
                           "COUNT_MISMATCH");
  }
  // Whether an index is one of the sent features only the caller can check, because it has the
  // query (CheckMatches in client/api/client.cc).
  for (const int feature : proto.feature_indices()) {
    matches->push_back({.feature = feature, .landmark = 0, .ratio = 1.0f});
  }
  inliers->assign(proto.inliers().begin(), proto.inliers().end());
  return Status::Ok();
}

bool IsAtLeastZero(double value) { return std::isfinite(value) && value >= 0.0; }

Result<std::optional<FocalScale>> FocalScaleFromProto(const v1::LocalizeResponse& response) {
  if (response.has_focal_length_scale() != response.has_focal_length_scale_sigma()) {
    return InvalidArgument("focal_length_scale_sigma", "must come with focal_length_scale alone",
                           "COUNT_MISMATCH");
  }
  if (!response.has_focal_length_scale()) return std::optional<FocalScale>();
  const FocalScale scale{response.focal_length_scale(), response.focal_length_scale_sigma()};
  if (!IsAtLeastZero(scale.scale) || scale.scale == 0.0) {
    return InvalidArgument("focal_length_scale", "must be positive", "OUT_OF_RANGE");
  }
  if (!IsAtLeastZero(scale.sigma)) {
    return InvalidArgument("focal_length_scale_sigma", "must be at least 0", "OUT_OF_RANGE");
  }
  return std::optional<FocalScale>(scale);
}

Result<Evidence> EvidenceFromProto(const v1::LocalizeResponse& response) {
  Evidence evidence;
  MAPLOC_ASSIGN_OR_RETURN(evidence.points, CountsFromProto(response.points(), "points"));
  MAPLOC_ASSIGN_OR_RETURN(evidence.usable_lines,
                          CountsFromProto(response.usable_lines(), "usable_lines"));
  MAPLOC_ASSIGN_OR_RETURN(evidence.vertical_lines,
                          CountsFromProto(response.vertical_lines(), "vertical_lines"));
  MAPLOC_ASSIGN_OR_RETURN(evidence.strategy,
                          convert::StrategyFromProto(response.strategy(), "strategy"));
  evidence.fell_back = response.fell_back();
  evidence.iterations = response.iteration_count();
  evidence.gravity_disagreement_rad = response.gravity_disagreement_radians();
  evidence.gravity_rejected = response.gravity_rejected();
  evidence.confidence = response.confidence();
  evidence.inlier_rms_px = response.inlier_rms_pixels();
  MAPLOC_ASSIGN_OR_RETURN(evidence.focal_scale, FocalScaleFromProto(response));
  return evidence;
}

// A NaN would go on as JSON's null, and make the median of a whole session one.
Status CheckNumbers(const v1::LocalizeResponse& response) {
  const v1::StageTimes& times = response.times();
  const std::pair<const char*, double> numbers[] = {
      {"confidence", response.confidence()},
      {"predicted_success", response.predicted_success()},
      {"gravity_disagreement_radians", response.gravity_disagreement_radians()},
      {"inlier_rms_pixels", response.inlier_rms_pixels()},
      {"iteration_count", static_cast<double>(response.iteration_count())},
      {"times.convert_ms", times.convert_ms()},
      {"times.retrieval_ms", times.retrieval_ms()},
      {"times.matching_ms", times.matching_ms()},
      {"times.ransac_ms", times.ransac_ms()},
      {"times.refinement_ms", times.refinement_ms()},
      {"times.total_ms", times.total_ms()}};
  for (const auto& [field, value] : numbers) {
    if (!IsAtLeastZero(value)) return InvalidArgument(field, "must be at least 0", "OUT_OF_RANGE");
  }
  return Status::Ok();
}

Result<PoseCovariance> CovarianceFromProto(const v1::LocalizeResponse& response) {
  if (response.covariance_size() != 36) {
    return InvalidArgument("covariance", "must hold 36 numbers", "COUNT_MISMATCH");
  }
  PoseCovariance covariance;
  for (int i = 0; i < 36; ++i) covariance(i / 6, i % 6) = response.covariance(i);
  if (!covariance.allFinite()) return InvalidArgument("covariance", "must be finite", "NOT_FINITE");
  // A client shows the root of a variance.
  for (int i = 0; i < 6; ++i) {
    if (covariance(i, i) >= 0.0) continue;
    return InvalidArgument(convert::At("covariance", 7 * i), "is a negative variance",
                           "OUT_OF_RANGE");
  }
  return covariance;
}

Status PoseFromProto(const v1::LocalizeResponse& response, Localization* result) {
  const bool localized = result->outcome == Outcome::kLocalized;
  if (localized != response.has_map_from_body()) {
    return InvalidArgument("map_from_body", "must come with LOCALIZED and with nothing else",
                           "POSE_WITHOUT_OUTCOME");
  }
  if (!localized) return Status::Ok();
  MAPLOC_ASSIGN_OR_RETURN(result->map_from_body,
                          Rigid3FromProto(response.map_from_body(), "map_from_body"));
  MAPLOC_ASSIGN_OR_RETURN(result->covariance, CovarianceFromProto(response));
  return Status::Ok();
}

}  // namespace

Result<Localization> LocalizationFromProto(const v1::LocalizeResponse& response,
                                           const std::string& map) {
  // An outcome of a newer server is refused, because nobody here knows whether it has a pose.
  if (response.outcome() < v1::OUTCOME_LOCALIZED ||
      response.outcome() > v1::OUTCOME_CALIBRATION_INCONSISTENT) {
    return convert::UnknownEnum("outcome", response.outcome());
  }
  if (response.strategy_source() < v1::STRATEGY_SOURCE_DEFAULT ||
      response.strategy_source() > v1::STRATEGY_SOURCE_REQUESTED) {
    return convert::UnknownEnum("strategy_source", response.strategy_source());
  }
  MAPLOC_RETURN_IF_ERROR(CheckNumbers(response));
  Localization result;
  result.outcome = static_cast<Outcome>(response.outcome());
  result.map = {map, response.map_version()};
  result.segment = response.segment_id();
  result.strategy_source = static_cast<StrategySource>(response.strategy_source());
  result.predicted_success = response.predicted_success();
  result.times = TimesFromProto(response.times());
  MAPLOC_ASSIGN_OR_RETURN(result.evidence, EvidenceFromProto(response));
  MAPLOC_RETURN_IF_ERROR(PoseFromProto(response, &result));
  MAPLOC_RETURN_IF_ERROR(MatchesFromProto(response.point_matches(), "point_matches",
                                          &result.matches.points, &result.point_match_inlier));
  MAPLOC_RETURN_IF_ERROR(MatchesFromProto(response.line_matches(), "line_matches",
                                          &result.matches.lines, &result.line_match_inlier));
  return result;
}

}  // namespace maploc
