#include "client/api/names.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/api/client.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

TEST(CheckNameTest, TakesTextOfAnyScript) {
  for (const char* name :
       {"", "rover-7", "caf\u00e9", "\u96f7", "\U0001f916", "\u07ff\u0800\uffff"}) {
    EXPECT_TRUE(CheckName("robot", name).ok()) << name;
  }
  EXPECT_TRUE(CheckName("robot", std::string(128, 'r')).ok());
}

TEST(CheckNameTest, RefusesWhatIsNotUtf8AndShowsItInPlainCharacters) {
  // Latin-1; a stray continuation; cut short; overlong; a surrogate; beyond the last code point.
  for (const char* name : {"caf\xe9", "\x80", "a\xe2\x82", "\xc0\xaf", "\xe0\x80\xaf",
                           "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xff"}) {
    const Status status = CheckName("robot", name);
    EXPECT_EQ(status.reason(), "NOT_UTF8");
    EXPECT_THAT(status.message(), HasSubstr("robot: '"));
    for (const char c : status.message()) EXPECT_TRUE(c >= 0x20 && c < 0x7f) << status.message();
  }
  EXPECT_THAT(CheckName("robot", "caf\xe9").message(), HasSubstr("'caf\\xe9'"));
}

TEST(CheckNameTest, RefusesWhatIsTooLongOrHoldsAControlCharacter) {
  EXPECT_EQ(CheckName("robot", std::string(129, 'r')).reason(), "TOO_LONG");
  EXPECT_EQ(CheckName("robot", "a\nb").reason(), "CONTROL_CHARACTER");
}

// No server is there: the refusal comes before the call.
TEST(ClientNamesTest, EveryNameIsCheckedBeforeTheCall) {
  const Client client("127.0.0.1:1");
  const std::string bad = "caf\xe9";
  Query named;
  named.request_id = bad;
  Query of_map;
  of_map.map = bad;
  const std::vector<std::pair<std::string, Status>> calls = {
      {"robot", client.StartSession("yard", bad, {}).status()},
      {"map", client.StartSession(bad, "rover", {}).status()},
      {"labels.season", client.StartSession("yard", "rover", {{"season", bad}}).status()},
      {"labels", client.StartSession("yard", "rover", {{bad, "x"}}).status()},
      {"request_id", client.Localize(named).status()},
      {"map", client.Localize(of_map).status()},
      {"map", client.GetMap(bad).status()},
      {"map", client.ListSegments(bad).status()},
      {"map", client.GetSegment(bad, 1).status()},
      {"session_id", client.EndSession(bad).status()},
  };
  for (const auto& [field, status] : calls) {
    EXPECT_EQ(status.reason(), "NOT_UTF8") << status.ToString();
    EXPECT_TRUE(status.message().starts_with(field + ": ")) << status.message();
  }
}

}  // namespace
}  // namespace maploc
