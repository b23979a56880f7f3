#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "client/api/client.h"

namespace maploc {
namespace {

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

TEST(ClientNamesTest, AQueryWithoutAViewIsRefusedBeforeTheCall) {
  Query blind;
  blind.map = "yard";
  const Status status = Client("127.0.0.1:1").Localize(blind).status();
  EXPECT_EQ(status.reason(), "REQUIRED");
  EXPECT_TRUE(status.message().starts_with("views: ")) << status.message();
}

}  // namespace
}  // namespace maploc
