#include "mapstore/statistics/probabilities.h"

#include <algorithm>

namespace maploc {
namespace {

// Draws of one kind: how many second entities there are, and how often one is right.
struct Kind {
  double weight = 0.0;
  double right = 0.0;
  SampleYield yield;
};

struct Kinds {
  Kind two_points;
  Kind point_and_line;
  Kind point_and_verticals;
};

// Of `count` things of which the share `rate` is right, one that is not the right one drawn first.
double RightAgain(double count, double rate) {
  return count > 1.0 ? std::max(0.0, (rate * count - 1.0) / (count - 1.0)) : 0.0;
}

Kinds KindsOf(const MatchCounts& counts, const InlierRates& rates, const SampleYields& yields) {
  Kinds kinds;
  kinds.two_points = {std::max(counts.points - 1.0, 0.0), RightAgain(counts.points, rates.points),
                      yields.two_points};
  kinds.point_and_line = {std::max(counts.usable_lines, 0.0), rates.usable_lines,
                          yields.point_and_line};
  if (DrawsVerticalLines(counts)) {
    kinds.point_and_verticals = {
        counts.vertical_lines - 1.0,
        rates.vertical_lines * RightAgain(counts.vertical_lines, rates.vertical_lines),
        yields.point_and_verticals};
  }
  return kinds;
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

bool DrawsVerticalLines(const MatchCounts& counts) {
  return counts.vertical_lines >= 2.0 && counts.vertical_lines > counts.usable_lines;
}

StrategyValues IterationProbabilities(const MatchCounts& counts, const InlierRates& rates,
                                      const SampleYields& yields) {
  StrategyValues values;
  if (counts.points < 1.0) return values;
  const Kinds kinds = KindsOf(counts, rates, yields);
  // Less than one whole line or second point (a mean over queries) cannot be counted on.
  const double lines = kinds.point_and_line.weight + kinds.point_and_verticals.weight;
  if (lines >= 1.0) {
    values.p1p1l = Succeeds(rates.points, {kinds.point_and_line, kinds.point_and_verticals});
  }
  if (counts.points >= 2.0) values.p2p = Succeeds(rates.points, {kinds.two_points});
  if (counts.points - 1.0 + lines >= 1.0) {
    values.mixed =
        Succeeds(rates.points, {kinds.two_points, kinds.point_and_line, kinds.point_and_verticals});
  }
  return values;
}

StrategyValues DrawProbabilities(const MatchCounts& counts, const InlierRates& rates) {
  return IterationProbabilities(counts, rates, NoGates());
}

}  // namespace maploc
