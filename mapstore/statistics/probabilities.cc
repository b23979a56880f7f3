#include "mapstore/statistics/probabilities.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace maploc {
namespace {

// Draws of one kind: how many second entities there are, and how often one is right.
struct Kind {
  double weight = 0.0;
  double right = 0.0;
  SampleYield yield;
};

// Of `count` things of which the share `rate` is right, one that is not the right one drawn first.
double RightAgain(double count, double rate) {
  return count > 1.0 ? std::max(0.0, (rate * count - 1.0) / (count - 1.0)) : 0.0;
}

Kind TwoPoints(const MatchCounts& counts, const InlierRates& rates, const SampleYields& yields) {
  return {std::max(counts.points - 1.0, 0.0), RightAgain(counts.points, rates.points),
          yields.two_points};
}

Kind PointAndLine(const MatchCounts& counts, const InlierRates& rates, const SampleYields& yields) {
  return {std::max(counts.usable_lines, 0.0), rates.usable_lines, yields.point_and_line};
}

// Without weight where vertical lines take no part.
Kind PointAndVerticals(Strategy strategy, const MatchCounts& counts, const InlierRates& rates,
                       const SampleYields& yields) {
  if (!DrawsVerticalLines(strategy, counts)) return {};
  return {counts.vertical_lines - 1.0,
          rates.vertical_lines * RightAgain(counts.vertical_lines, rates.vertical_lines),
          yields.point_and_verticals};
}

// The share of evaluated draws which succeed, where the second entity is drawn from all of `kinds`.
double Succeeds(double lambda, std::initializer_list<Kind> kinds) {
  double good = 0.0;
  double evaluated = 0.0;
  for (const Kind& kind : kinds) {
    const double right = lambda * kind.right;
    good += kind.weight * right * kind.yield.good;
    evaluated += kind.weight * (right * kind.yield.good + (1.0 - right) * kind.yield.bad);
  }
  return evaluated > 0.0 ? std::clamp(good / evaluated, 0.0, 1.0) : 0.0;
}

}  // namespace

bool DrawsVerticalLines(Strategy strategy, const MatchCounts& counts) {
  const auto rounded = [](double count) {
    return static_cast<std::size_t>(std::llround(std::max(count, 0.0)));
  };
  return DrawsVerticalLines(strategy, rounded(counts.usable_lines), rounded(counts.vertical_lines));
}

StrategyValues IterationProbabilities(const MatchCounts& counts, const InlierRates& rates,
                                      const SampleYields& yields) {
  StrategyValues values;
  if (counts.points < 1.0) return values;
  const Kind points = TwoPoints(counts, rates, yields);
  const Kind lines = PointAndLine(counts, rates, yields);
  // Less than one whole line or second point (a mean over queries) cannot be counted on.
  const Kind of_1p1l = PointAndVerticals(Strategy::k1P1L, counts, rates, yields);
  if (lines.weight + of_1p1l.weight >= 1.0) {
    values.p1p1l = Succeeds(rates.points, {lines, of_1p1l});
  }
  if (counts.points >= 2.0) values.p2p = Succeeds(rates.points, {points});
  const Kind of_mixed = PointAndVerticals(Strategy::kMixed, counts, rates, yields);
  if (points.weight + lines.weight + of_mixed.weight >= 1.0) {
    values.mixed = Succeeds(rates.points, {points, lines, of_mixed});
  }
  return values;
}

StrategyValues DrawProbabilities(const MatchCounts& counts, const InlierRates& rates) {
  return IterationProbabilities(counts, rates, NoGates());
}

}  // namespace maploc
