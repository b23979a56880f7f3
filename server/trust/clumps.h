// Features that stand or fall together: those of one thing that was moved, or taken for another.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace maploc {

// How many of the points are evidence of their own. Points are joined to clumps, each with all that
// are nearer than `gap`; of a clump no wider than `width` (the diagonal of its box) two count, of a
// wider one all. Deterministic, in any order of the points; O(n) for each in a strip of `gap`.
int CountByClumps(std::vector<Eigen::Vector2d> points, double gap, double width);

}  // namespace maploc
