// Decides whether a refined pose may be reported, and why not.
#pragma once

#include <optional>
#include <string_view>

#include "mapstore/geometry/camera.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/matches.h"
#include "server/refinement/refine.h"
#include "server/trust/gravity_check.h"

namespace maploc {

struct TrustOptions {
  RefineOptions refine;  // as the pose was refined
  double min_confidence = 0.99;
  // The problem holds the gravity that was sent, even if `has_gravity` is false. In that case the
  // pose was found without gravity and is compared with it.
  bool gravity_was_sent = false;
  // Hypotheses evaluated for this query so far, over all segments. Each could agree by chance.
  int iterations = 1;
  double sampled_share = 1.0;  // of the view's points that were matched
};

// Why a pose is not reported.
enum class Doubt {
  kNone,
  kChance,        // wrong matches agree as well (confidence.h)
  kUndetermined,  // its inliers do not determine it (determination.h)
  kRival,         // another pose explains nearly as much (rival.h)
  kMirrored,      // a mirrored picture explains more (rival.h)
  kGravity,       // the matches contradict the gravity that it was found with (gravity_check.h)
  kCalibration,   // the matches contradict the calibration (calibration.h)
};

struct Verdict {
  Outcome outcome = Outcome::kLowConfidence;  // or kLocalized, kGravityInconsistent,
                                              // kCalibrationInconsistent
  Doubt doubt = Doubt::kChance;               // kNone with kLocalized
  double confidence = 0.0;
  RefinedPose pose;       // the judged one: the one that was found, or a rival that explains more
  bool is_rival = false;  // from three points, without gravity
  GravityCheck gravity;   // of that pose against the gravity that was sent
  std::optional<FocalScale> focal_scale;
};

// `found` was refined in `problem`. A rival that clearly explains more takes its place.
// Deterministic; thread-safe.
Verdict JudgePose(const PoseProblem& problem, const RefinedPose& found, const Camera& camera,
                  const TrustOptions& options);

// Whether the lines agree with the pose no more than wrong lines would (LinesAgreeByChance). If so,
// search, refinement and judgement must leave them out.
bool LinesAreAtChance(const PoseProblem& problem, const RefinedPose& pose, const Camera& camera,
                      const TrustOptions& options);

// Matches and inliers by kind, under `pose`. The kinds that a strategy cannot use count as well.
Evidence CountEvidence(const PoseProblem& problem, const RefinedPose& pose);

}  // namespace maploc
