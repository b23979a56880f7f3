#include "mapstore/base/names.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/base/ids.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

TEST(CheckNameTest, TakesWhatPeopleCallThings) {
  for (const char* name : {"", "yard", "two words",
                           "Stra\xC3\x9F"
                           "e",
                           "\xE5\xBA\xAD", "\xF0\x9F\xA4\x96"}) {
    EXPECT_TRUE(CheckName("map", name).ok()) << name;
  }
  EXPECT_TRUE(CheckName("map", std::string(kMaxIdBytes, 'a')).ok());
}

TEST(CheckNameTest, NamesTheFieldAndTheFault) {
  const auto expect = [](const std::string& name, const char* reason, const char* message) {
    const Status status = CheckName("robot", name);
    EXPECT_EQ(status.reason(), reason);
    EXPECT_THAT(status.message(), HasSubstr(message));
  };
  expect(std::string(129, 'a'), "TOO_LONG", "robot: is 129 bytes long, at most 128 are allowed");
  expect("a\nb", "CONTROL_CHARACTER", "robot: holds a control character");
  expect(
      "Stra\xDF"
      "e",
      "NOT_UTF8", "robot: is not UTF-8 at byte 4");
}

TEST(FindNonUtf8Test, RefusesWhatOnlyLooksLikeIt) {
  EXPECT_FALSE(FindNonUtf8("a\xC3\xA9\xE2\x82\xAC\xF4\x8F\xBF\xBF").has_value());
  for (const char* text : {"\x80", "\xC3", "\xC3(", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80",
                           "\xF4\x90\x80\x80", "\xF0\x80\x80\xAF", "\xFF", "\xE2\x82"}) {
    EXPECT_EQ(FindNonUtf8(text), 0u);
    EXPECT_EQ(FindNonUtf8(std::string("ab") + text), 2u);
  }
}

}  // namespace
}  // namespace maploc
