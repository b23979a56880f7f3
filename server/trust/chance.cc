#include "server/trust/chance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace maploc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAccidents = 2.0;  // so many agreements are no pattern, however few are expected

double LogChoose(int n, int k) {
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
}

}  // namespace

double LogBinomialTail(int n, int k, double p) {
  if (k <= 0) return 0.0;
  if (k > n || p <= 0) return -kInfinity;
  if (p >= 1) return 0.0;
  const double log_p = std::log(p);
  const double log_q = std::log1p(-p);
  double largest = -kInfinity;
  std::vector<double> terms;
  for (int i = k; i <= n; ++i) {
    terms.push_back(LogChoose(n, i) + i * log_p + (n - i) * log_q);
    largest = std::max(largest, terms.back());
    // Past the mode the terms fall at least geometrically: the rest is below rounding.
    if (i > n * p && terms.back() < largest - 40.0) break;
  }
  double sum = 0.0;
  for (const double term : terms) sum += std::exp(term - largest);
  return std::min((largest + std::log(sum)) / std::log(10.0), 0.0);
}

double CombineLogPValues(double log_p1, double log_p2) {
  const double log_product = log_p1 + log_p2;
  if (log_product == -kInfinity) return -kInfinity;
  return std::min(log_product + std::log10(1.0 - log_product * std::log(10.0)), 0.0);
}

double ShareBeyondAccident(const PairCount& count, double expected_share) {
  const double expected = expected_share * static_cast<double>(count.pairs);
  const double agreeing = static_cast<double>(count.agreeing);
  if (agreeing <= expected + 3.0 * std::sqrt(expected) + kAccidents) return expected_share;
  return agreeing / static_cast<double>(count.pairs);
}

std::int64_t AgreeingByRepetition(const std::vector<std::int64_t>& per_landmark) {
  std::int64_t all = 0;
  std::int64_t landmarks = 0;  // with any
  for (const std::int64_t agreeing : per_landmark) {
    all += agreeing;
    landmarks += agreeing > 0 ? 1 : 0;
  }
  const double count = static_cast<double>(per_landmark.size());
  if (count == 0) return 0;
  const std::int64_t excess = all - landmarks;
  const double share = std::min(static_cast<double>(landmarks) / count, 1.0 - 0.5 / count);
  const double excess_of_pattern = (-std::log1p(-share) - share) * count;
  const bool exchanged = static_cast<double>(excess) + kAccidents < 0.5 * excess_of_pattern;
  return exchanged ? excess : all;
}

}  // namespace maploc
