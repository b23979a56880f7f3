// May the robot rely on this pose? The last stage: evidence in, an outcome out.
#pragma once

#include "mapstore/geometry/camera.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/matches.h"
#include "server/refinement/refine.h"

namespace maploc {

struct JudgeOptions {
  bool contradicts_gravity = false;  // that was sent and was used to find the pose
  double min_confidence = 0.99;
  double max_reprojection_error_px = 4.0;  // that decided the inliers
  // Hypotheses evaluated for this query so far, over all segments: each had its chance to be right
  // by chance.
  int iterations = 1;
};

struct Verdict {
  Outcome outcome = Outcome::kLowConfidence;  // kLocalized, kLowConfidence, kGravityInconsistent
  double confidence = 0.0;
};

// LOW_CONFIDENCE below the bar, and where the matches that are left over hold another pose nearly
// as well (rival.h); above it GRAVITY_INCONSISTENT when the matches contradict the gravity that was
// sent (gravity_check.h); else LOCALIZED.
Verdict JudgePose(const PoseProblem& problem, const RefinedPose& pose, const Camera& camera,
                  const JudgeOptions& options);

// Matches and inliers by kind, under `pose`. The kinds that a strategy cannot use count as well.
Evidence CountEvidence(const PoseProblem& problem, const RefinedPose& pose);

}  // namespace maploc
