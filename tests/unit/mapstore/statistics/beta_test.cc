#include "mapstore/statistics/beta.h"

#include <cmath>

#include <gtest/gtest.h>

namespace maploc {
namespace {

// References: mpmath's betainc with 30 digits.
TEST(BetaCdf, EqualsKnownValues) {
  struct Known {
    double a, b, x, cdf;
  };
  for (const Known& known :
       {Known{2, 3, 0.1, 0.0523}, Known{2, 3, 0.6, 0.8208}, Known{2, 3, 0.0025, 3.73751171875e-5},
        Known{0.5, 9.5, 0.1, 0.837450000970273}, Known{0.5, 9.5, 0.5, 0.999662118361969},
        Known{0.5, 9.5, 0.0025, 0.170413994003786}, Known{12, 88, 0.1, 0.285112338229045},
        Known{12, 88, 0.0025, 4.50696949715447e-17}, Known{3000, 2000, 0.5, 5.19577893763985e-46},
        Known{3000, 2000, 0.6, 0.499232212054409}, Known{1, 1, 0.25, 0.25}}) {
    EXPECT_NEAR(BetaCdf({known.a, known.b}, known.x) / known.cdf, 1.0, 1e-10)
        << known.a << " " << known.b << " " << known.x;
  }
}

TEST(BetaCdf, IsSymmetricAndBounded) {
  // Powers of two, so that 1 - x is exact.
  for (const double x : {-1.0, 0.0, 0x1p-40, 0.1875, 0.5, 1.0 - 0x1p-10, 1.0, 2.0}) {
    for (const double a : {1e-3, 0.5, 7.0, 4e5}) {
      for (const double b : {1e-3, 0.5, 7.0, 4e5}) {
        const double cdf = BetaCdf({a, b}, x);
        EXPECT_GE(cdf, 0.0);
        EXPECT_LE(cdf, 1.0);
        EXPECT_NEAR(cdf + BetaCdf({b, a}, 1.0 - x), 1.0, 1e-8) << a << " " << b << " " << x;
      }
    }
  }
}

TEST(BetaQuantile, EqualsKnownValues) {
  struct Known {
    double a, b, probability, quantile;
  };
  for (const Known& known :
       {Known{2, 3, 0.025, 0.067585986488543}, Known{2, 3, 0.975, 0.80587955031676},
        Known{0.5, 9.5, 0.025, 5.3064053418492e-5}, Known{0.5, 9.5, 0.975, 0.2376100986329},
        Known{12, 88, 0.005, 0.051541633558059}, Known{12, 88, 0.995, 0.21658035202792}}) {
    EXPECT_NEAR(BetaQuantile({known.a, known.b}, known.probability), known.quantile, 1e-11);
  }
}

TEST(BetaQuantile, OfAPointMassIsThePoint) {
  for (const double probability : {0.0, 0.025, 1.0}) {
    EXPECT_EQ(BetaQuantile({0.0, 5.0}, probability), 0.0);
    EXPECT_EQ(BetaQuantile({5.0, 0.0}, probability), 1.0);
  }
  EXPECT_EQ((BetaDistribution{0.0, 0.0}.Mean()), 0.0);
  const BetaQuadrature quadrature = QuadratureOf({5.0, 0.0});
  for (int i = 0; i < kBetaNodes; ++i) EXPECT_EQ(quadrature.node[i], 1.0);
}

TEST(CredibleInterval, LeavesEqualTails) {
  const BetaDistribution beta = {12, 88};
  const Interval interval = CredibleInterval(beta, 0.95);
  EXPECT_NEAR(BetaCdf(beta, interval.low), 0.025, 1e-10);
  EXPECT_NEAR(BetaCdf(beta, interval.high), 0.975, 1e-10);
}

// E[x^k] = product over i < k of (a + i) / (a + b + i), exactly up to the ninth.
TEST(QuadratureOf, HasTheMomentsOfTheDistribution) {
  for (const double a : {0.05, 0.5, 3.0, 80.0, 5e4}) {
    for (const double b : {0.05, 1.0, 7.0, 900.0}) {
      const BetaQuadrature quadrature = QuadratureOf({a, b});
      double moment = 1.0;
      for (int k = 0; k <= 9; ++k) {
        double sum = 0.0;
        for (int i = 0; i < kBetaNodes; ++i) {
          sum += quadrature.weight[i] * std::pow(quadrature.node[i], k);
        }
        EXPECT_NEAR(sum / moment, 1.0, 1e-9) << a << " " << b << " moment " << k;
        moment *= (a + k) / (a + b + k);
      }
      for (int i = 1; i < kBetaNodes; ++i) EXPECT_GT(quadrature.node[i], quadrature.node[i - 1]);
    }
  }
}

}  // namespace
}  // namespace maploc
