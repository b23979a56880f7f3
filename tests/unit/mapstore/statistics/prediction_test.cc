#include "mapstore/statistics/prediction.h"

#include <cmath>

#include <gtest/gtest.h>

namespace maploc {
namespace {

// 50 points and 20 usable lines a query; with the prior, lambda ~ Beta(12, 38) and gamma ~ Beta(20,
// 30).
SegmentStatistics Segment() {
  SegmentStatistics s;
  s.sessions = 1;
  s.queries = s.localized = 10;
  s.weighted_queries = s.weighted_localized = 10.0;
  s.point_matches = 400.0;
  s.point_inliers = 90.0;
  s.independent_points = 40.0;
  s.usable_line_matches = 80.0;
  s.usable_line_inliers = 34.0;
  s.independent_usable_lines = 40.0;
  s.typical_point_matches = 50.0;
  s.typical_usable_line_matches = 20.0;
  return s;
}

// Of draws, all of which are evaluated.
SelectorOptions Within(std::int64_t iterations) {
  SelectorOptions options;
  options.yields = NoGates();
  options.max_iterations = iterations;
  return options;
}

TEST(PosteriorsOf, AddAWeakPriorToIndependentMatches) {
  const RatePosteriors nothing = PosteriorsOf({}, {});
  EXPECT_DOUBLE_EQ(nothing.points.a, 3.0);
  EXPECT_DOUBLE_EQ(nothing.points.b, 7.0);
  const RatePosteriors some = PosteriorsOf(Segment(), {});
  EXPECT_DOUBLE_EQ(some.points.a, 12.0);
  EXPECT_DOUBLE_EQ(some.points.b, 38.0);
  EXPECT_DOUBLE_EQ(some.usable_lines.a, 20.0);
  EXPECT_DOUBLE_EQ(some.usable_lines.b, 30.0);
  EXPECT_EQ(some.vertical_lines, nothing.vertical_lines);
}

// References: the double integrals over both posteriors, by mpmath's adaptive quadrature.
TEST(PredictStrategies, IntegratesOverThePosteriors) {
  struct Known {
    std::int64_t most;
    double query_1p1l, iterations_1p1l, query_2p, iterations_2p;
  };
  for (const Known& known : {Known{10, 0.6188733245, 6.680033333, 0.4240509424, 7.845344835},
                             Known{100, 0.9990928826, 11.46796001, 0.9715760357, 21.81354464}}) {
    const StrategyPrediction prediction = PredictStrategies(Segment(), Within(known.most));
    EXPECT_NEAR(prediction.p1p1l.query_probability, known.query_1p1l, 2e-3);
    EXPECT_NEAR(prediction.p1p1l.expected_iterations / known.iterations_1p1l, 1.0, 5e-3);
    EXPECT_NEAR(prediction.p2p.query_probability, known.query_2p, 5e-3);
    EXPECT_NEAR(prediction.p2p.expected_iterations / known.iterations_2p, 1.0, 2e-2);
  }
}

// E[lambda gamma] = E[lambda] E[gamma]; E[lambda (lambda p - 1) / (p - 1)] needs the second moment
// of Beta(12, 38), 12 x 13 / (50 x 51). More than at the mean: a rate that may be higher helps more
// than one that may be lower harms.
TEST(PredictStrategies, ExpectsAnIterationToSucceedOverThePosterior) {
  const StrategyPrediction prediction = PredictStrategies(Segment(), Within(10000));
  EXPECT_NEAR(prediction.p1p1l.iteration_probability, 0.24 * 0.4, 1e-12);
  EXPECT_NEAR(prediction.p1p1l.draw_probability, 0.24 * 0.4, 1e-12);
  const double second = 12.0 * 13.0 / (50.0 * 51.0);
  EXPECT_NEAR(prediction.p2p.iteration_probability, (50.0 * second - 0.24) / 49.0, 1e-6);
  EXPECT_NEAR(prediction.p2p.draw_probability, 0.24 * 11.0 / 49.0, 1e-12);
  EXPECT_GT(prediction.p2p.iteration_probability, prediction.p2p.draw_probability);
}

// The less is known, the more may be lost: the same means, but a tenth of the evidence.
TEST(PredictStrategies, UncertaintyCostsTime) {
  SelectorOptions options = Within(1000);
  options.prior_matches = 0.0;
  SegmentStatistics sure = Segment();
  sure.independent_points = sure.independent_usable_lines = 4000.0;
  SegmentStatistics unsure = Segment();
  unsure.independent_points = unsure.independent_usable_lines = 20.0;
  const StrategyPrediction a = PredictStrategies(sure, options);
  const StrategyPrediction b = PredictStrategies(unsure, options);
  for (const Strategy strategy : kSelectableStrategies) {
    EXPECT_NEAR(a.Of(strategy).draw_probability, b.Of(strategy).draw_probability, 1e-12);
    EXPECT_GT(b.Of(strategy).expected_time, 1.05 * a.Of(strategy).expected_time);
  }
  // With all this evidence time is what the mean says: cost / probability.
  EXPECT_NEAR(a.p1p1l.expected_time * a.p1p1l.draw_probability, 1.0, 0.01);
}

// 8 lines at 0.2: in 0.8^8 of the queries none is right, and 1P1L is lost there, however surely its
// rates are known; 2P is not. (Pooled rates alone would promise success in all of them.)
TEST(PredictStrategies, AQueryHasAWholeNumberOfRightLines) {
  SegmentStatistics s = Segment();
  s.point_matches = s.independent_points = 1e9;
  s.point_inliers = 0.2e9;
  s.usable_line_matches = s.independent_usable_lines = 1e9;
  s.usable_line_inliers = 0.2e9;
  s.typical_usable_line_matches = 8.0;
  const StrategyPrediction prediction = PredictStrategies(s, Within(10000));
  const double lost = std::pow(0.8, 8);
  EXPECT_NEAR(prediction.p1p1l.query_probability, 1.0 - lost, 1e-4);
  EXPECT_NEAR(prediction.p1p1l.expected_iterations,
              10000 * lost + (1.0 - lost) * (1.0 - lost) / 0.04, 10.0);
  EXPECT_GT(prediction.p2p.query_probability, 0.999);
  EXPECT_GT(prediction.mixed.query_probability, 0.999);
  EXPECT_LT(prediction.p2p.expected_time, prediction.p1p1l.expected_time / 10.0);
}

// A posterior that reaches down to 0 does not make time infinite: a search ends.
TEST(PredictStrategies, TimeIsFiniteWhereverSuccessIsPossible) {
  SegmentStatistics poor = Segment();
  poor.point_inliers = 1.0;
  SelectorOptions options = Within(1000);
  options.prior_matches = 0.1;
  const StrategyPrediction prediction = PredictStrategies(poor, options);
  for (const Strategy strategy : kSelectableStrategies) {
    const StrategyOutlook& outlook = prediction.Of(strategy);
    EXPECT_TRUE(std::isfinite(outlook.expected_time));
    EXPECT_LE(outlook.expected_iterations, 1000.0 + 1e-6);
    EXPECT_GT(outlook.query_probability, 0.0);
    EXPECT_LE(outlook.query_probability, 1.0);
  }
}

TEST(PredictStrategies, WhatCannotSucceedTakesForever) {
  const StrategyPrediction nothing = PredictStrategies({});
  SegmentStatistics bare = Segment();
  bare.typical_usable_line_matches = 0.0;
  const StrategyPrediction no_lines = PredictStrategies(bare);
  EXPECT_TRUE(std::isinf(no_lines.p1p1l.expected_time));
  EXPECT_EQ(no_lines.p1p1l.query_probability, 0.0);
  EXPECT_DOUBLE_EQ(no_lines.mixed.expected_iterations, no_lines.p2p.expected_iterations);
  for (const Strategy strategy : kSelectableStrategies) {
    EXPECT_TRUE(std::isinf(nothing.Of(strategy).expected_time));
    EXPECT_EQ(nothing.Of(strategy).iteration_probability, 0.0);
  }
}

TEST(PredictStrategies, AnIterationsCostIsTime) {
  SelectorOptions cheap;
  cheap.cost_1p1l = 1.0;
  SelectorOptions dear;
  dear.cost_1p1l = 3.0;
  EXPECT_DOUBLE_EQ(PredictStrategies(Segment(), dear).p1p1l.expected_time,
                   3.0 * PredictStrategies(Segment(), cheap).p1p1l.expected_time);
}

}  // namespace
}  // namespace maploc
