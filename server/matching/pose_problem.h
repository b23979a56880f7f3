// From matches to the geometric problem that the estimator solves.
#pragma once

#include <optional>

#include "mapstore/model/map.h"
#include "mapstore/model/matches.h"
#include "mapstore/model/query.h"

namespace maploc {

// The problem and the matches that it was made from, in the same order: problem.points[i] is
// matches.points[i], and lines alike.
struct MatchedProblem {
  Matches matches;
  PoseProblem problem;
};

// Undistorts the matched features with the view's camera, and turns gravity from the body into the
// camera. Matches whose features the camera cannot have seen (Camera::Normalize fails) are dropped,
// and so are lines that shrink to a point. REQUIRES: the matches name the view's features and the
// segment's landmarks. Deterministic; thread-safe.
MatchedProblem BuildPoseProblem(const Matches& matches, const View& view, const Segment& segment,
                                const std::optional<Gravity>& gravity);

}  // namespace maploc
