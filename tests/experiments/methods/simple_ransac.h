// A plain RANSAC around any minimal solver, for the baselines: the product's scoring, iterations,
// redraws and local optimization, so that only the minimal solver makes a difference.
#pragma once

#include <functional>

#include "mapstore/base/random.h"
#include "server/ransac/prepared_problem.h"
#include "tests/experiments/methods/method.h"

namespace maploc::experiments {

inline constexpr int kMaxRedraws = 10;  // of a draw without a solution, as the product's
inline constexpr int kMaxSolutions = 8;

// Draws one sample and solves it: the number of poses written, 0 where there is none.
using DrawAndSolve = std::function<int(const PreparedProblem&, Random&, PoseMatrix*)>;

// The probability that a draw is all inliers, from the inlier counts of points and lines.
using DrawChance =
    std::function<double(int points, int point_inliers, int lines, int line_inliers)>;

// The best pose (camera_from_map), not refined; `iterations` takes how many were run. nullopt
// where nothing scores.
std::optional<Rigid3> SimpleRansac(const PoseProblem& problem, const MethodOptions& options,
                                   const DrawAndSolve& draw, const DrawChance& chance,
                                   int* iterations);

// `count` different indices below `size`. REQUIRES: count <= size.
void DrawDistinct(std::uint32_t size, int count, Random& random, std::uint32_t* indices);

}  // namespace maploc::experiments
