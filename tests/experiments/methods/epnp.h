// EPnP (Lepetit, Moreno-Noguer, Fua 2009) as a minimal solver: OpenCV's, on a sample of points.
#pragma once

#include "server/ransac/prepared_problem.h"

namespace maploc::experiments {

inline constexpr int kEpnpSample = 6;
inline constexpr int kEpnpLeast = 4;

// One draw of 6 points (5 or 4 where there are no more). Returns 0 or 1: a finite pose with the
// sample in front of the camera.
int DrawAndSolveEpnp(const PreparedProblem& problem, Random& random, PoseMatrix* camera_from_map);

}  // namespace maploc::experiments
