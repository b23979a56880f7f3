#include "mapstore/base/name.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace maploc {
namespace {

TEST(CheckName, TakesWhatPeopleCallTheirThings) {
  for (const char* name : {"", "yard", "Halle 7 (Nord)", "Zürich", "倉庫", "گاراژ\u200cها",
                           "robot 🤖", "a/b\\c\"d'"}) {
    EXPECT_TRUE(CheckName("map", name).ok()) << name;
  }
  EXPECT_TRUE(CheckName("map", std::string(128, 'a')).ok());
}

TEST(CheckName, RefusesWhatWouldForgeALineOrHideOne) {
  const std::vector<std::string> forged = {std::string("ya\nrd"),    std::string("ya\0rd", 5),
                                           std::string("\x1b[31m"),  std::string("\x7f"),
                                           std::string("\u009b31m"), std::string("a\u2028b"),
                                           std::string("a\u2029b"),  std::string("\u202egnp.exe"),
                                           std::string("\u2066a"),   std::string("\ufeffyard")};
  for (const std::string& name : forged) {
    const Status status = CheckName("map", name);
    EXPECT_EQ(status.reason(), "CONTROL_CHARACTER") << ::testing::PrintToString(name);
    EXPECT_TRUE(status.message().starts_with("map: ")) << status.message();
  }
}

TEST(CheckName, RefusesWhatIsNotUtf8) {
  for (const char* name : {"M\xfcnchen", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
    EXPECT_EQ(CheckName("robot", name).reason(), "NOT_UTF8") << ::testing::PrintToString(name);
  }
}

TEST(CheckName, RefusesTooManyBytes) {
  EXPECT_EQ(CheckName("map", std::string(129, 'a')).reason(), "TOO_LONG");
  std::string umlauts;
  for (int i = 0; i < 65; ++i) umlauts += "ü";
  EXPECT_EQ(CheckName("map", umlauts).reason(), "TOO_LONG");
}

}  // namespace
}  // namespace maploc
