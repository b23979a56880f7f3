// Pieces of the a-contrario test: tails of the binomial, and how often a WRONG pair agrees under a
// pose. Pure functions.
#pragma once

#include <vector>

#include "server/refinement/refine.h"
#include "server/solvers/reprojection.h"

namespace maploc {

// log10 P(Binomial(n, p) >= k). 0 for k <= 0, -infinity for k > n or (p = 0 and k > 0).
double LogBinomialTail(int n, int k, double p);

// log10 of the probability that the product of two independent p-values is at most theirs:
// x (1 - ln x) (Fisher).
double CombineLogPValues(double log_p1, double log_p2);

// Evidence of one feature type under a pose.
struct Agreement {
  int matches = 0;
  int distinct_inliers = 0;      // features closer together than the threshold count once
  double wrong_pair_rate = 0.0;  // share of (feature i, landmark j != i) that agree, i and j apart
};

// `threshold` in the plane z = 1. Looks at no more than about 500 x 500 pairs, evenly spread.
Agreement PointAgreement(const std::vector<PointCorrespondence>& points,
                         const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                         double threshold);
Agreement LineAgreement(const std::vector<LineCorrespondence>& lines,
                        const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                        double threshold, double min_length);

// Area of the plane z = 1 over which the features spread: that of the rectangle whose uniform
// distribution has their covariance. 0 for fewer than 3.
double SpreadArea(const std::vector<Eigen::Vector2d>& features);

}  // namespace maploc
