// Pieces of the a-contrario test: tails of the binomial, and how often a WRONG match agrees with a
// pose. Pure functions.
#pragma once

#include <cstdint>
#include <vector>

#include "server/refinement/refine.h"
#include "server/solvers/reprojection.h"

namespace maploc {

// log10 P(Binomial(n, p) >= k). 0 for k <= 0, -infinity for k > n or (p = 0 and k > 0).
double LogBinomialTail(int n, int k, double p);

// log10 of the probability that the product of two independent p-values is at most theirs:
// x (1 - ln x) (Fisher).
double CombineLogPValues(double log_p1, double log_p2);

// Pairs that were looked at, and how many of them agreed.
struct PairCount {
  std::int64_t pairs = 0;
  std::int64_t agreeing = 0;
};

// The share of agreeing pairs where it is significantly more than `expected_share`, else that: a
// handful of accidents among few pairs is no pattern (three standard deviations, and two pairs).
double ShareBeyondAccident(const PairCount& count, double expected_share);

// Features that agree with wrong matches' landmarks (so many with each) because places repeat: all,
// unless wrong matches have merely exchanged their features. Then every landmark's own feature
// agrees with it under the true pose, one with each and hardly ever two. Where places repeat the
// numbers are Poisson's, and a share f of landmarks with any goes with -ln(1 - f) - f more a
// landmark: found less than half of that, beyond accident, only the excess counts.
std::int64_t AgreeingByRepetition(const std::vector<std::int64_t>& per_landmark);

// Evidence of one feature type under a pose.
struct Agreement {
  int matches = 0;
  // Features closer together than the threshold count once; and of points in a clump of their own
  // two (clumps.h: a sign that was moved agrees with a wrong pose by all its features or none).
  int distinct_inliers = 0;
  PairCount wrong_pairs;      // (feature i, outlier's landmark j) with i and j seen apart
  double shared_shift = 0.0;  // see below; 0 unless it is more than accident
};

// `shared_shift`: how probable is it that two wrong matches are off alike? Match i is off by d_i =
// seen_i - projected_i. In a picture of equal windows, where each match takes a window of its own
// for another, wrong matches agree in being some windows off, and a pose that explains "none off"
// is as probable as one that explains "one off". It is the share of pairs of outliers, seen apart,
// whose d agree within sqrt(2) thresholds or a twentieth of their length (perspective); d below
// four thresholds is the tail of the pose's own noise and left out.
//
// `threshold`, `clump_width` and lengths in the plane z = 1. Looks at no more than about 100,000
// pairs, evenly spread; O(n log n) otherwise.
Agreement PointAgreement(const std::vector<PointCorrespondence>& points,
                         const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                         double threshold, double clump_width);

// Lines are compared with lines of like direction in the image alone (10 degrees): a row of windows
// is taken for another row, never for a column, so that the share among all pairs would flatter.
// d is the shift across the line.
Agreement LineAgreement(const std::vector<LineCorrespondence>& lines,
                        const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                        double threshold, double min_length);

// Area of the plane z = 1 over which the features spread: that of the rectangle whose uniform
// distribution has their covariance. 0 for fewer than 3.
double SpreadArea(const std::vector<Eigen::Vector2d>& features);

}  // namespace maploc
