// Searches a rival: another pose that explains the matches nearly as well, or better.
//
// Where a pattern repeats in depth (doors along a corridor, windows of an oblique facade), wrong
// matches agree with the camera moved by one step, and others with the camera moved by two. The
// test against chance does not detect this, because such agreement is not due to chance. When the
// sent gravity is wrong, every pose found with it is wrong too; the true pose is then usually found
// among the outliers. A true pose has no rival, because its outliers are inconsistent with each
// other.
#pragma once

#include <cstddef>
#include <optional>

#include "mapstore/model/matches.h"
#include "server/refinement/refine.h"
#include "server/trust/confidence.h"

namespace maploc {

// The pose with most inliers among the outliers of `pose`, searched with gravity (where the problem
// has it) and without. It is refined by these outliers; its flags cover all matches. Conditions:
// * among these outliers it has at least `needed` inliers (InliersOfRival);
// * it is more than kMaxSpread (determination.h) away, further than the noise of one pose;
// * it has at most 1000 false alarms by the test that the pose itself has passed, because among
//   many matches five agree with some pose by accident.
// A search has as many iterations as find so many inliers among the outliers, at most
// kRivalIterations. With too few outliers there is no search, so that a pose that explains most of
// the matches costs nothing. `options.iterations` is not used. Deterministic; thread-safe.
std::optional<RefinedPose> FindRival(const PoseProblem& problem, const RefinedPose& pose,
                                     std::size_t needed, const ConfidenceOptions& options);

// Whether the outliers of `pose` agree better with a mirrored picture, which front cameras and
// faulty tools send. As FindRival, with every feature's x negated, without gravity, and counting
// only inliers that can be seen from where the mirrored picture was taken.
bool LooksMirrored(const PoseProblem& problem, const RefinedPose& pose,
                   const ConfidenceOptions& options);

// The fewest inliers that cast doubt on a pose with this many: two fifths of them, at least 5.
// Where there are many, 20 are enough, or a fiftieth: so many agree with a second pose only if the
// scene has two, such as a truck that was moved, before walls that were not. `sampled_share`: the
// matches are those of this share of the features, and 20 of all are fewer of them.
std::size_t InliersOfRival(std::size_t inliers, double sampled_share = 1.0);
std::size_t InliersOfCloseRival(std::size_t inliers);  // the two fifths

inline constexpr int kRivalIterations = 500;

}  // namespace maploc
