// A second opinion: is there another pose that explains the matches nearly as well, or better?
//
// Where a pattern repeats in depth (doors along a corridor, windows of an oblique facade), wrong
// matches agree with the camera moved by one step, and others with the camera moved by two. The
// test against chance cannot see it: such agreement is no chance. And where gravity was wrong,
// every pose found with it is, and the true one stands in what is left over. But truth has no
// rival: what is left over under the true pose is wrong in many ways.
#pragma once

#include <cstddef>
#include <optional>

#include "mapstore/model/matches.h"
#include "server/refinement/refine.h"
#include "server/trust/confidence.h"

namespace maploc {

// The pose with most inliers among the outliers of `pose`, searched with gravity, where the problem
// has it, and without; refined by these outliers, its flags those of all matches. It has at least
// kRivalShare of the inliers of `pose`, and kLeastRival, among these outliers; it is more than
// kMaxSpread (determination.h) away, which one pose's noise is not; and it has at most 1000 false
// alarms by the test that the pose itself has passed: among
// many matches five agree with some pose by accident. As many iterations a search as find so many
// inliers among what is left over, at most kRivalIterations; none where too little is left over, so
// that a pose that explains most of the matches costs nothing.
// `options.iterations` is not looked at. Deterministic; thread-safe.
std::optional<RefinedPose> FindRival(const PoseProblem& problem, const RefinedPose& pose,
                                     const ConfidenceOptions& options);

// Whether the matches that `pose` leaves over agree better with a picture that was mirrored: front
// cameras and careless tools do that. As FindRival, with every feature's x turned over, without
// gravity, and by inliers that can be seen from where the mirrored picture was taken.
bool LooksMirrored(const PoseProblem& problem, const RefinedPose& pose,
                   const ConfidenceOptions& options);

inline constexpr double kRivalShare = 0.4;
inline constexpr std::size_t kLeastRival = 5;
inline constexpr int kRivalIterations = 500;

}  // namespace maploc
