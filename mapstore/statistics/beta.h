// The Beta distribution: what is known of a rate after some good and some bad trials. Pure
// functions, thread-safe, the same bits for the same arguments.
#pragma once

#include <array>

namespace maploc {

// Density ~ x^(a - 1) (1 - x)^(b - 1) on [0, 1]. Where a or b is not positive it is the point mass
// at Mean().
struct BetaDistribution {
  double a = 1.0;
  double b = 1.0;
  bool operator==(const BetaDistribution&) const = default;

  // 0 where both are 0.
  double Mean() const;
};

// Probability of a value of at most x: the regularized incomplete beta function, by its continued
// fraction (Lentz's method; Numerical Recipes, 3rd edition, section 6.4). Relative error below
// 1e-10 for a and b up to 1e4, 1e-8 up to 1e6.
double BetaCdf(const BetaDistribution& beta, double x);

// The x with BetaCdf(x) = probability, to 1e-12. REQUIRES: 0 <= probability <= 1.
double BetaQuantile(const BetaDistribution& beta, double probability);

struct Interval {
  double low = 0.0;
  double high = 1.0;
  bool operator==(const Interval&) const = default;
};

// Equal tails. REQUIRES: 0 < probability < 1.
Interval CredibleInterval(const BetaDistribution& beta, double probability);

// Gauss-Jacobi quadrature: sum of weight[i] f(node[i]) is the expectation of f, exactly for
// polynomials of a degree up to 9 (Golub and Welsch, 1969). Nodes ascend; weights sum to 1.
inline constexpr int kBetaNodes = 5;
struct BetaQuadrature {
  std::array<double, kBetaNodes> node;
  std::array<double, kBetaNodes> weight;
};
BetaQuadrature QuadratureOf(const BetaDistribution& beta);

}  // namespace maploc
