// Confidence: the probability that a pose is right. Pure functions over the evidence.
//
// The worst error is to report a wrong pose as right. The test therefore asks: how probable is it
// that matches WITHOUT any true match among them agree with some pose this well?
//
// A-contrario test (Desolneux, Moisan, Morel 2000; Moisan and Stival 2004): under chance each match
// agrees with a given pose with probability p, independently. Of n matches k agree; s of these are
// used up by the pose's own degrees of freedom. Number of false alarms
//     NFA = tests * P(Binomial(n - s, p) >= k - s),
// tests = 20 poses per iteration (two solutions, and the poses of local optimization), over at
// least 100 iterations. Points and lines have their own p and tail, combined by Fisher
// (CombineLogPValues). p is the largest of
//   * the inlier disc's share of the area that the matched features cover;
//   * the share of WRONG pairs (feature i, landmark j != i) that agree under this very pose: it
//     detects repeated patterns, clusters, and cameras so far away that the whole map is a dot;
//   * three times the share of wrong matches that have the same displacement (chance.h);
//   * for lines, a prior of one in ten that is worth 60 pairs.
// Features closer together than the threshold count once. A pose that gravity does not support
// (none in the problem) needs an NFA four decades lower.
//
// Calibrated: of many answers with a confidence c, the share c is right, in a population where one
// query in thirty has any true match (MEASUREMENTS.md). Where more queries have one, more answers
// are right.
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
  // Width of a clump (clumps.h): features of one thing that is moved, or mistaken for another, as a
  // whole. A share of the image's diagonal, of at most a VGA-sized image's. 0: every feature
  // counts.
  double clump_share = 0.08;
};

// Probability in [0, 1] that the pose is right and not due to chance. LOCALIZED requires 0.99 by
// default. Deterministic; thread-safe.
double PoseConfidence(const PoseProblem& problem, const RefinedPose& pose,
                      const ConfidenceOptions& options);

// The calibration: converts log10 of the number of false alarms to a probability. Strictly monotone
// between its limits, 0.0037 and 0.9999.
double ConfidenceOf(double log_false_alarms);

// In decades of false alarms. A freely rotated grid of equal windows matches itself in many ways,
// and its matches then agree by dozens. An upright grid matches itself by shifts alone, which the
// test for shared displacements detects. A pose that gravity does not support therefore needs an
// NFA lower by this much.
inline constexpr double kDoubtWithoutGravity = 4.0;

// log10 of the number of false alarms: the test inside PoseConfidence. Negative is good.
double LogNumberOfFalseAlarms(const PoseProblem& problem, const RefinedPose& pose,
                              const ConfidenceOptions& options);

// Whether the lines agree with the pose no more than wrong lines would. Such lines are no evidence,
// and search and refinement should not use them. False without lines. Deterministic; thread-safe.
bool LinesAgreeByChance(const PoseProblem& problem, const RefinedPose& pose,
                        const ConfidenceOptions& options);

}  // namespace maploc
