// May this pose be trusted? Pure functions over the evidence.
//
// A wrong pose given as right is the worst that can happen, so the question is asked the other way
// round: how probable is it that matches WITHOUT any truth in them agree with some pose this well?
//
// A-contrario test (Desolneux, Moisan, Morel 2000; Moisan and Stival 2004): under chance each match
// agrees with a given pose with probability p, independently; n matches, k agree, s of them are
// used up by the pose's own freedom. Number of false alarms
//     NFA = tests * P(Binomial(n - s, p) >= k - s),
// tests = 2 poses an iteration, times a constant for local optimization. Points and lines have
// their own p and tail, combined by Fisher (CombineLogPValues). p is the largest of
//   * the inlier disc's share of the area that the matched features cover;
//   * the share of WRONG pairs (feature i, landmark j != i) that agree under this very pose: it
//   sees
//     repeated patterns, clusters and cameras so far away that the whole map is a dot;
//   * three times the share of wrong matches that are off alike (chance.h);
//   * of lines, a prior of one in ten that is worth 60 pairs.
// Features closer together than the threshold count once. A pose that gravity does not support
// (none in the problem) needs four decades more.
//
// Calibrated: of many answers told with a confidence c, the share c is right, in a population where
// one query of thirty holds any truth (README); where more do, more are right.
#pragma once

#include "mapstore/model/localization.h"
#include "mapstore/model/matches.h"
#include "server/refinement/refine.h"

namespace maploc {

// What the test needs to know besides the matches.
struct ConfidenceOptions {
  double max_reprojection_error_px = 4.0;  // that decided the inliers
  int image_width_px = 640;
  int image_height_px = 480;
  int iterations = 1;  // evaluated hypotheses, Consensus::iterations
  // Of the image's diagonal, but of no more than a VGA-sized image's: as wide as what is moved, or
  // taken for another, as a whole (clumps.h). With 0 every feature counts.
  double clump_share = 0.08;
};

// Probability in [0, 1] that the pose is not the work of chance. 0.99 is the bar for LOCALIZED.
// Deterministic; thread-safe.
double PoseConfidence(const PoseProblem& problem, const RefinedPose& pose,
                      const ConfidenceOptions& options);

// The calibration: from log10 of the number of false alarms to a probability. Strictly monotone but
// for its ends, 0.0037 and 0.9999.
double ConfidenceOf(double log_false_alarms);

// In decades of false alarms. A grid of equal windows falls onto itself in many ways when it may be
// turned freely, and its matches then agree by dozens; upright it does so by shifts alone, and for
// those Chance looks. So a pose that gravity does not support needs so much more.
inline constexpr double kDoubtWithoutGravity = 4.0;

// log10 of the number of false alarms: the test inside PoseConfidence. Negative is good.
double LogNumberOfFalseAlarms(const PoseProblem& problem, const RefinedPose& pose,
                              const ConfidenceOptions& options);

// Whether the lines agree with the pose no more than wrong lines would: then they are no evidence,
// and neither a search nor a refinement should hear them. False without lines. Deterministic;
// thread-safe.
bool LinesAgreeByChance(const PoseProblem& problem, const RefinedPose& pose,
                        const ConfidenceOptions& options);

}  // namespace maploc
