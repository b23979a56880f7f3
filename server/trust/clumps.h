// Clumps: features of one thing, which is moved or mistaken for another as a whole. All of them
// agree with a wrong pose, or none.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace maploc {

// The number of points that count as independent evidence. Points nearer to each other than `gap`
// are joined to clumps. A clump no wider than `width` (the diagonal of its box) counts as two
// points at most; in a wider one every point counts. Deterministic, in any order of the points;
// O(n) for each in a strip of `gap`.
int CountByClumps(std::vector<Eigen::Vector2d> points, double gap, double width);

}  // namespace maploc
