#include "maploc/v1/localization_service.pb.h"
#include "proto/convert/checks.h"
#include "proto/convert/convert.h"

namespace maploc {
namespace {

void CountsToProto(const FeatureCounts& counts, v1::FeatureCounts* proto) {
  proto->set_match_count(counts.matches);
  proto->set_inlier_count(counts.inliers);
}

void TimesToProto(const StageTimes& times, v1::StageTimes* proto) {
  proto->set_convert_ms(times.convert_ms);
  proto->set_retrieval_ms(times.retrieval_ms);
  proto->set_matching_ms(times.matching_ms);
  proto->set_ransac_ms(times.ransac_ms);
  proto->set_refinement_ms(times.refinement_ms);
  proto->set_total_ms(times.total_ms);
}

void MatchesToProto(const std::vector<FeatureMatch>& matches,
                    const std::vector<std::uint8_t>& inliers, v1::FeatureMatches* proto) {
  for (const FeatureMatch& match : matches) proto->add_feature_indices(match.feature);
  // Without a consensus there are matches and no verdicts: none agrees.
  std::string verdicts(matches.size(), '\0');
  for (std::size_t i = 0; i < std::min(matches.size(), inliers.size()); ++i) {
    verdicts[i] = inliers[i] != 0 ? '\1' : '\0';
  }
  proto->set_inliers(std::move(verdicts));
}

void EvidenceToProto(const Evidence& evidence, v1::LocalizeResponse* response) {
  response->set_confidence(evidence.confidence);
  response->set_strategy(convert::StrategyToProto(evidence.strategy));
  response->set_fell_back(evidence.fell_back);
  response->set_iteration_count(evidence.iterations);
  response->set_gravity_disagreement_radians(evidence.gravity_disagreement_rad);
  response->set_gravity_rejected(evidence.gravity_rejected);
  response->set_inlier_rms_pixels(evidence.inlier_rms_px);
  if (evidence.focal_scale) {
    response->set_focal_length_scale(evidence.focal_scale->scale);
    response->set_focal_length_scale_sigma(evidence.focal_scale->sigma);
  }
  CountsToProto(evidence.points, response->mutable_points());
  CountsToProto(evidence.usable_lines, response->mutable_usable_lines());
  CountsToProto(evidence.vertical_lines, response->mutable_vertical_lines());
}

void PoseToProto(const Localization& localization, v1::LocalizeResponse* response) {
  Rigid3ToProto(*localization.map_from_body, response->mutable_map_from_body());
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      response->add_covariance(localization.covariance(row, column));
    }
  }
}

}  // namespace

void LocalizationToProto(const Query& query, const Localization& localization, bool include_matches,
                         v1::LocalizeResponse* response) {
  response->Clear();
  response->set_outcome(static_cast<v1::Outcome>(localization.outcome));
  if (localization.map_from_body) PoseToProto(localization, response);
  response->set_map_version(localization.map.version);
  response->set_segment_id(localization.segment);
  response->set_strategy_source(static_cast<v1::StrategySource>(localization.strategy_source));
  response->set_predicted_success(localization.predicted_success);
  EvidenceToProto(localization.evidence, response);
  TimesToProto(localization.times, response->mutable_times());
  // Echoed, so that a robot with several queries on their way can tell the answers apart.
  response->set_request_id(query.request_id);
  response->set_capture_unix_nanos(query.capture_unix_ns);
  if (include_matches) {
    MatchesToProto(localization.matches.points, localization.point_match_inlier,
                   response->mutable_point_matches());
    MatchesToProto(localization.matches.lines, localization.line_match_inlier,
                   response->mutable_line_matches());
  }
}

}  // namespace maploc
