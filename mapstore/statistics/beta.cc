#include "mapstore/statistics/beta.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace maploc {
namespace {

constexpr double kTiny = 1e-300;
constexpr double kConverged = 1e-15;
constexpr int kMaxTerms = 20000;  // it takes O(sqrt(max(a, b)))

bool IsPointMass(const BetaDistribution& beta) { return !(beta.a > 0.0 && beta.b > 0.0); }

// Stirling's series; std::lgamma writes a global variable, a race between threads. x > 0.
double LogGamma(double x) {
  double shift = 0.0;
  for (; x < 10.0; x += 1.0) shift -= std::log(x);
  const double r = 1.0 / (x * x);
  const double series =
      (1.0 / 12 - r * (1.0 / 360 - r * (1.0 / 1260 - r * (1.0 / 1680 - r / 1188)))) / x;
  return shift + (x - 0.5) * std::log(x) - x + 0.91893853320467274 + series;  // log(2 pi) / 2
}

// Lentz's method divides by these values, so a zero becomes a tiny number.
double NotZero(double value) { return std::abs(value) < kTiny ? kTiny : value; }

// Converges fast for x < (a + 1) / (a + b + 2).
double ContinuedFraction(double a, double b, double x) {
  double c = 1.0;
  double d = 1.0 / NotZero(1.0 - (a + b) * x / (a + 1.0));
  double value = d;
  for (int m = 1; m <= kMaxTerms; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1.0) * (a + 2 * m));
    d = 1.0 / NotZero(1.0 + even * d);
    c = NotZero(1.0 + even / c);
    value *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1.0));
    d = 1.0 / NotZero(1.0 + odd * d);
    c = NotZero(1.0 + odd / c);
    value *= d * c;
    if (std::abs(d * c - 1.0) < kConverged) break;
  }
  return value;
}

// The recurrence of the monic Jacobi polynomials on [-1, 1] for (1 - t)^alpha (1 + t)^beta, moved
// to [0, 1]: diagonal and squared subdiagonal (Gautschi, Orthogonal Polynomials, table 1.1).
double Diagonal(double alpha, double beta, int n) {
  const double sum = alpha + beta;
  const double t = n == 0 ? (beta - alpha) / (sum + 2.0)
                          : (beta - alpha) * sum / ((2 * n + sum) * (2 * n + sum + 2.0));
  return 0.5 * (1.0 + t);
}

double SquaredSubdiagonal(double alpha, double beta, int n) {
  const double sum = alpha + beta;
  const double t =
      n == 1 ? 4.0 * (1.0 + alpha) * (1.0 + beta) / ((2.0 + sum) * (2.0 + sum) * (3.0 + sum))
             : 4.0 * n * (n + alpha) * (n + beta) * (n + sum) /
                   ((2 * n + sum) * (2 * n + sum) * (2 * n + sum + 1.0) * (2 * n + sum - 1.0));
  return 0.25 * t;
}

}  // namespace

double BetaDistribution::Mean() const {
  const double total = std::max(a, 0.0) + std::max(b, 0.0);
  return total > 0.0 ? std::max(a, 0.0) / total : 0.0;
}

double BetaCdf(const BetaDistribution& beta, double x) {
  if (IsPointMass(beta)) return x >= beta.Mean() ? 1.0 : 0.0;
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  const auto& [a, b] = beta;
  const double front =
      std::exp(LogGamma(a + b) - LogGamma(a) - LogGamma(b) + a * std::log(x) + b * std::log1p(-x));
  // The fraction converges fast on one side only. The other side follows from I_x(a, b) = 1 - I_(1
  // - x)(b, a).
  const double value = x < (a + 1.0) / (a + b + 2.0)
                           ? front * ContinuedFraction(a, b, x) / a
                           : 1.0 - front * ContinuedFraction(b, a, 1.0 - x) / b;
  return std::clamp(value, 0.0, 1.0);
}

// Bisection: as many steps as there are bits, whatever the shape.
double BetaQuantile(const BetaDistribution& beta, double probability) {
  if (IsPointMass(beta)) return beta.Mean();
  double low = 0.0;
  double high = 1.0;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (BetaCdf(beta, middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Interval CredibleInterval(const BetaDistribution& beta, double probability) {
  const double tail = 0.5 * (1.0 - probability);
  return {BetaQuantile(beta, tail), BetaQuantile(beta, 1.0 - tail)};
}

BetaQuadrature QuadratureOf(const BetaDistribution& beta) {
  BetaQuadrature quadrature;
  if (IsPointMass(beta)) {
    quadrature.node.fill(beta.Mean());
    quadrature.weight.fill(1.0 / kBetaNodes);
    return quadrature;
  }
  using Nodes = Eigen::Matrix<double, kBetaNodes, 1>;
  Nodes diagonal;
  Eigen::Matrix<double, kBetaNodes - 1, 1> subdiagonal;
  for (int n = 0; n < kBetaNodes; ++n) {
    diagonal[n] = Diagonal(beta.b - 1.0, beta.a - 1.0, n);
    if (n > 0) subdiagonal[n - 1] = std::sqrt(SquaredSubdiagonal(beta.b - 1.0, beta.a - 1.0, n));
  }
  // Golub and Welsch: the nodes are the eigenvalues of this tridiagonal matrix, the weights the
  // squared first components of its eigenvectors.
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kBetaNodes, kBetaNodes>> solver;
  solver.computeFromTridiagonal(diagonal, subdiagonal, Eigen::ComputeEigenvectors);
  for (int n = 0; n < kBetaNodes; ++n) {
    quadrature.node[n] = std::clamp(solver.eigenvalues()[n], 0.0, 1.0);
    quadrature.weight[n] = solver.eigenvectors()(0, n) * solver.eigenvectors()(0, n);
  }
  return quadrature;
}

}  // namespace maploc
