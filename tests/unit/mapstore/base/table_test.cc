#include "mapstore/base/table.h"

#include <sstream>

#include <gtest/gtest.h>

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

TEST(Table, ColourTakesNoWidth) {
  Table table({"outcome", "n"});
  table.AddRow({"\033[32mfound\033[0m", "1"});
  std::ostringstream out;
  table.Print(out);
  EXPECT_EQ(out.str(), "outcome  n\n-------  -\n\033[32mfound\033[0m    1\n");
}

}  // namespace
}  // namespace maploc
