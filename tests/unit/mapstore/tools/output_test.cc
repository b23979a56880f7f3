#include "mapstore/tools/output.h"

#include <gmock/gmock.h>

#include "mapstore/tools/plot_svg.h"

namespace maploc {
namespace {

TEST(FormatRatio, ShowsThatThereIsNone) {
  EXPECT_EQ(FormatRatio(std::nullopt), "-");
  EXPECT_EQ(FormatRatio(0.73449), "0.734");
  EXPECT_TRUE(JsonRatio(std::nullopt).is_null());
  EXPECT_EQ(JsonRatio(0.25), 0.25);
}

TEST(PlotSvg, EscapesNamesAndColoursByStrategy) {
  SegmentSummary segment;
  segment.path_in_map = {{0, 0, 0}, {5, 0, 0}};
  segment.decision.strategy = Strategy::k2P;
  const auto landmarks = std::make_shared<Segment>();
  landmarks->points.positions_in_map = {{1, 1, 1}};
  const std::string svg = PlotSvg("<b>&", PlotColour::kStrategy, {segment}, {{}}, {landmarks});
  EXPECT_THAT(svg, ::testing::HasSubstr("&lt;b>&amp;"));
  EXPECT_THAT(svg, ::testing::HasSubstr("stroke='#1b9e77' points="));
  EXPECT_THAT(svg, ::testing::Not(::testing::HasSubstr("nan")));
}

TEST(PlotSvg, OfNothingIsStillAPicture) {
  EXPECT_THAT(PlotSvg("empty", PlotColour::kChange, {}, {}, {}), ::testing::HasSubstr("</svg>"));
}

TEST(PlotSvg, ColoursAndLegendTellOfChanges) {
  SegmentSummary segment;
  segment.path_in_map = {{0, 0, 0}, {5, 0, 0}};
  segment.statistics.queries = 9;
  ChangePoint gone;
  gone.before = 0.6;
  gone.after = 0.0;
  ChangePoint better = gone;
  std::swap(better.before, better.after);
  const auto landmarks = std::make_shared<Segment>();
  const auto plot = [&](const std::vector<ChangePoint>& changes) {
    return PlotSvg("yard", PlotColour::kChange, {segment}, {{0, changes}}, {landmarks});
  };
  EXPECT_THAT(plot({gone, better}), ::testing::HasSubstr("stroke='#a50026' points="));
  EXPECT_THAT(plot({better}), ::testing::HasSubstr("stroke='#313695' points="));
  EXPECT_THAT(plot({}), ::testing::HasSubstr("stroke='#4d4d4d' points="));
  EXPECT_THAT(plot({}), ::testing::HasSubstr("half lost"));
}

TEST(Declines, AreRankedByWhatIsLost) {
  const auto change = [](ChangeKind kind, double before, double after) {
    ChangePoint point;
    point.kind = kind;
    point.before = before;
    point.after = after;
    return point;
  };
  const auto declines = RankDeclines(
      {{3, {change(ChangeKind::kPoints, 0.6, 0.3)}},
       {5, {change(ChangeKind::kPoints, 0.2, 0.4), change(ChangeKind::kLines, 0.4, 0.1)}},
       {7, {}}});
  ASSERT_EQ(declines.size(), 2u);
  EXPECT_EQ(declines[0].segment, 5);
  EXPECT_EQ(declines[0].change.kind, ChangeKind::kLines);
  EXPECT_DOUBLE_EQ(declines[0].Loss(), 0.75);
  EXPECT_EQ(declines[1].segment, 3);
}

}  // namespace
}  // namespace maploc
