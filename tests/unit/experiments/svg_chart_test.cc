#include "tests/experiments/svg_chart.h"

#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>

namespace maploc::experiments {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pointwise;

// Every opened element is closed in order, and no text is left unescaped.
bool IsWellFormed(const std::string& svg) {
  std::vector<std::string> open;
  for (std::size_t at = 0; (at = svg.find('<', at)) != std::string::npos;) {
    const std::size_t end = svg.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = svg.substr(at + 1, end - at - 1);
    if (tag.find('<') != std::string::npos) return false;
    if (tag.starts_with("/")) {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else if (!tag.ends_with("/")) {
      open.push_back(tag.substr(0, tag.find(' ')));
    }
    at = end;
  }
  for (std::size_t at = 0; (at = svg.find('&', at)) != std::string::npos; ++at) {
    if (svg.find(';', at) > at + 6) return false;
  }
  return open.empty();
}

Chart TwoSeries() {
  return {.title = "errors <&> 'more' \"quotes\"",
          .x_label = "noise",
          .y_label = "error",
          .panels = {{"10 inliers", {{"2p", {{0, 1}, {1, 2}}}, {"p3p", {{0, 2}, {1, 4}}}}}}};
}

TEST(DrawSvg, IsWellFormedWhateverTheNames) {
  const std::string svg = DrawSvg(TwoSeries());
  EXPECT_TRUE(IsWellFormed(svg)) << svg;
  EXPECT_THAT(svg, HasSubstr("errors &lt;&amp;&gt; &apos;more&apos; &quot;quotes&quot;"));
}

TEST(DrawSvg, NamesEverySeriesOnceInTheLegendHoweverManyPanels) {
  Chart chart = TwoSeries();
  chart.panels.push_back(chart.panels.front());
  const std::string svg = DrawSvg(chart);
  const std::size_t first = svg.find(">p3p</text>");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(svg.find(">p3p</text>", first + 1), std::string::npos);
}

TEST(DrawSvg, LeavesOutWhatAnAxisCannotShow) {
  Chart chart = TwoSeries();
  chart.log_x = chart.log_y = true;  // x 0 has no place
  chart.panels[0].series[0].points.push_back({2, std::numeric_limits<double>::quiet_NaN()});
  chart.panels[0].series[0].points.push_back({3, std::numeric_limits<double>::infinity()});
  const std::string svg = DrawSvg(chart);
  EXPECT_TRUE(IsWellFormed(svg));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(DrawSvg, OfNothingOrOfOnePointIsStillAPicture) {
  EXPECT_TRUE(IsWellFormed(DrawSvg({})));
  Chart chart;
  chart.panels = {{"one", {{"a", {{1, 1}}}}}};
  const std::string svg = DrawSvg(chart);
  EXPECT_TRUE(IsWellFormed(svg));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(AxisTicks, AreRoundAndInside) {
  EXPECT_THAT(AxisTicks(0, 1, 5, false),
              Pointwise(::testing::DoubleEq(), {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
  EXPECT_THAT(AxisTicks(0.02, 0.5, 6, true),
              Pointwise(::testing::DoubleEq(), {0.02, 0.05, 0.1, 0.2, 0.5}));
  EXPECT_THAT(AxisTicks(1, 1e5, 6, true),
              Pointwise(::testing::DoubleEq(), {1.0, 10.0, 100.0, 1000.0, 1e4, 1e5}));
}

}  // namespace
}  // namespace maploc::experiments
