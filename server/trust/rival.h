// A second opinion: do the matches that a pose leaves over hold another pose nearly as well?
//
// Where a pattern repeats in depth (doors along a corridor, windows of an oblique facade), wrong
// matches agree with the camera moved by one step, and others with the camera moved by two. The
// test against chance cannot see it: such agreement is no chance. But truth has no rival: what is
// left over under the true pose is wrong in many ways.
#pragma once

#include <cstddef>

#include "mapstore/model/matches.h"
#include "server/refinement/refine.h"
#include "server/trust/confidence.h"

namespace maploc {

// Whether the outliers of `pose` hold another pose with at least kRivalShare of its inliers, and
// kLeastRival. Another: more than kMaxSpread (determination.h) away, which one pose's noise is not.
// Among many matches five agree with some pose by accident: a rival has at most 1000 false alarms
// by the test that the pose itself has passed. Samples are drawn with gravity where the problem has
// it. At most kRivalIterations; nothing where too little is left over. `options.iterations` is not
// looked at. Deterministic; thread-safe.
bool HasRival(const PoseProblem& problem, const RefinedPose& pose,
              const ConfidenceOptions& options);

inline constexpr double kRivalShare = 0.4;
inline constexpr std::size_t kLeastRival = 5;
inline constexpr int kRivalIterations = 500;

}  // namespace maploc
