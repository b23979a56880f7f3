// The answer to one query: a pose with its evidence, or the reason why there is none.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "mapstore/base/ids.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/matches.h"
#include "mapstore/model/strategy.h"

namespace maploc {

// "Not localized" is a normal answer. A pose comes with kLocalized alone. The numbers are the
// wire's.
enum class Outcome {
  kLocalized = 1,
  kTooFewMatches = 2,
  kNoConsensus = 3,              // no hypothesis gathered more support than chance
  kLowConfidence = 4,            // a pose was found but its evidence is too weak to be trusted
  kGravityInconsistent = 5,      // the pose contradicts the gravity that was sent
  kOutOfMap = 6,                 // no segment could be near
  kCalibrationInconsistent = 7,  // the matches contradict the camera's calibration that was sent
};

std::string_view OutcomeName(Outcome outcome);  // "LOCALIZED", "TOO_FEW_MATCHES", ...

// Row-major order x, y, z, rotX, rotY, rotZ: fixed axes of the map frame, as
// geometry_msgs/PoseWithCovariance. (map unit, rad)
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

struct FeatureCounts {
  std::int32_t matches = 0;
  std::int32_t inliers = 0;  // under the FINAL pose, after refinement
  bool operator==(const FeatureCounts&) const = default;
};

// True focal length over the one that was sent.
struct FocalScale {
  double scale = 1.0;  // positive
  double sigma = 0.0;  // standard deviation of `scale`
  bool operator==(const FocalScale&) const = default;
};

// What the estimator saw, for the answer and for the statistics. Of many points, a sample
// may have been counted for all (server/pipeline/coarse_to_fine.h).
struct Evidence {
  FeatureCounts points;
  FeatureCounts usable_lines;            // tilt of 10 degrees or more
  FeatureCounts vertical_lines;          // the others
  Strategy strategy = Strategy::kMixed;  // that found the pose; without a pose the most promising
  bool fell_back = false;                // `strategy` is not the one that was chosen at first
  std::int32_t iterations = 0;           // evaluated hypotheses, over all strategies tried
  // Between the measured gravity and that of the pose as the matches alone give it (a pose that was
  // pulled by a wrong gravity would hide it); 0 where either is missing.
  double gravity_disagreement_rad = 0.0;
  // The same with its way: the turn about the map's x and y axes that takes the map's gravity to
  // the measured one, as the matches alone have it; zero where either is missing.
  Eigen::Vector2d gravity_tilt_rad = Eigen::Vector2d::Zero();
  // With kLocalized alone: the pose contradicts the gravity that was sent, and does not use it.
  bool gravity_rejected = false;
  double confidence = 0.0;     // probability that the pose is right, in [0, 1]
  double inlier_rms_px = 0.0;  // root mean square of the inliers' reprojection errors, pixels; 0
                               // without a pose
  // As the matches alone have it; unset where they do not determine it.
  std::optional<FocalScale> focal_scale;
};

// Where the time of one Localize went, in order of the pipeline.
struct StageTimes {
  double convert_ms = 0.0;
  double retrieval_ms = 0.0;
  double matching_ms = 0.0;
  double ransac_ms = 0.0;
  double refinement_ms = 0.0;
  double total_ms = 0.0;
};

struct Localization {
  Outcome outcome = Outcome::kNoConsensus;
  MapKey map;
  SegmentId segment = -1;  // the one that answered, else the best ranked; -1 with kOutOfMap
  std::optional<Rigid3> map_from_body;                 // with kLocalized alone
  PoseCovariance covariance = PoseCovariance::Zero();  // never zero with kLocalized
  Evidence evidence;
  StrategySource strategy_source =
      StrategySource::kDefault;    // of the segment's recorded (or requested) strategy
  double predicted_success = 0.0;  // of one iteration with the recorded strategy; 0 before evidence
  StageTimes times;
  // In the segment that answered. Where evidence is of a sample, others follow the sample's points,
  // which were looked for near the pose: they make it more precise, and say nothing for it.
  Matches matches;
  std::vector<std::uint8_t> point_match_inlier;  // one a point match, 0 or 1
  std::vector<std::uint8_t> line_match_inlier;   // one a line match
};

}  // namespace maploc
