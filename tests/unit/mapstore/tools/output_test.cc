#include "mapstore/tools/output.h"

#include <sstream>

#include <gmock/gmock.h>

#include "mapstore/tools/plot_svg.h"

namespace maploc {
namespace {

TEST(Table, PadsColumnsToTheirWidestCell) {
  Table table({"map", "points"});
  table.AddRow({"a", "12"});
  table.AddRow(
      {"h\xc3\xb6"
       "fe",
       "3"});  // four letters in five bytes
  std::ostringstream out;
  table.Print(out);
  EXPECT_EQ(out.str(),
            "map   points\n----  ------\na     12\nh\xc3\xb6"
            "fe  3\n");
}

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
  const std::string svg = PlotSvg("<b>&", {segment}, {landmarks});
  EXPECT_THAT(svg, ::testing::HasSubstr("&lt;b>&amp;"));
  EXPECT_THAT(svg, ::testing::HasSubstr("stroke='#1b9e77' points="));
  EXPECT_THAT(svg, ::testing::Not(::testing::HasSubstr("nan")));
}

TEST(PlotSvg, OfNothingIsStillAPicture) {
  EXPECT_THAT(PlotSvg("empty", {}, {}), ::testing::HasSubstr("</svg>"));
}

}  // namespace
}  // namespace maploc
