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

// The share of agreeing pairs if it is significantly above `expected_share`, else `expected_share`:
// a few accidents among few pairs are no pattern (margin: three standard deviations and two pairs).
double ShareBeyondAccident(const PairCount& count, double expected_share);

// Number of agreements between features and wrong matches' landmarks that come from repeated
// places; `per_landmark` has the number of each landmark. All of them count, unless the wrong
// matches have merely exchanged their features: then each landmark agrees with its own feature
// under the true pose, and hardly ever with a second one. The test: repeated places give Poisson
// numbers. If a share f of the landmarks has at least one, the mean is m = -ln(1 - f) per landmark,
// so m - f per landmark are second or later ones. If there are less than half as many of these
// (after allowing for accidents), the features were exchanged, and only these count.
std::int64_t AgreeingByRepetition(const std::vector<std::int64_t>& per_landmark);

// Evidence of one feature type under a pose.
struct Agreement {
  int matches = 0;
  // Features closer together than the threshold count once. Points of one separate clump count as
  // two (clumps.h): all features of a sign that was moved agree with a wrong pose, or none.
  int distinct_inliers = 0;
  PairCount wrong_pairs;      // (feature i, outlier's landmark j) with i and j seen apart
  double shared_shift = 0.0;  // see below; 0 unless it is more than accident
};

// `shared_shift`: the probability that two wrong matches have the same displacement. The
// displacement of match i is d_i = seen_i - projected_i. In a picture of equal windows, where each
// match confuses its window with another one, wrong matches share displacements of some windows,
// and a pose that explains "no window off" is as probable as one that explains "one window off".
// `shared_shift` is the share of pairs of outliers, seen apart, whose d agree within sqrt(2)
// thresholds or a twentieth of their length (perspective). A d below four thresholds is the tail of
// the pose's own noise and is left out.
//
// `threshold`, `clump_width` and lengths are in the plane z = 1. Compares at most about 100,000
// pairs, evenly spread; O(n log n) otherwise.
Agreement PointAgreement(const std::vector<PointCorrespondence>& points,
                         const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                         double threshold, double clump_width);

// Lines are compared only with lines of similar direction in the image (10 degrees). A row of
// windows is confused with another row, never with a column, so the share among all pairs would be
// too low. d is the displacement perpendicular to the line.
Agreement LineAgreement(const std::vector<LineCorrespondence>& lines,
                        const std::vector<std::uint8_t>& inliers, const PoseMatrix& pose,
                        double threshold, double min_length);

// Area of the plane z = 1 over which the features spread: that of the rectangle whose uniform
// distribution has their covariance. 0 for fewer than 3.
double SpreadArea(const std::vector<Eigen::Vector2d>& features);

}  // namespace maploc
