// The log of a server that asks for tokens: it names robots and reasons, and no secret.
#include <gmock/gmock.h>

#include "tests/integration/access/access_fixture.h"
#include "tests/support/server_process.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(AccessTest, NoSecretIsInTheLog) {
  const std::string good = NewToken(Role::kRobot, "rover");
  const std::string foreign = "maploc-" + std::string(16, 'a') + "-" + std::string(64, 'b');
  ServerProcess server(folder_, {"--log-requests", "1", "--log-level", "debug"});
  const std::string address = server.Start();
  const auto connect = [&address](const std::string& token) {
    ClientOptions options;
    options.max_attempts = 1;
    options.credentials.token = token;
    return Client(address, options);
  };
  const Client robot = connect(good);
  const Result<SessionId> session = robot.StartSession("street", "rover", {});
  ASSERT_TRUE(session.ok()) << session.status().ToString();
  EXPECT_TRUE(robot.Localize(QueryIn(*session)).ok());
  EXPECT_EQ(robot.ListSegments("attic").status().reason(), "MAP_NOT_FOUND");
  EXPECT_EQ(connect(foreign).ListMaps().status().reason(), "TOKEN_WRONG");
  EXPECT_EQ(connect("maploc-secret").ListMaps().status().reason(), "TOKEN_MALFORMED");
  server.Stop();

  const std::string log = folder_.Read("stderr");
  for (const char* told : {"TOKEN_WRONG", "TOKEN_MALFORMED", "method=\"Localize\"",
                           "reason=\"MAP_NOT_FOUND\"", "robot=\"rover\""}) {
    EXPECT_THAT(log, HasSubstr(told));
  }
  for (const std::string& secret : {ParseToken(good)->secret, HashSecret(ParseToken(good)->secret),
                                    std::string(64, 'b'), std::string("maploc-secret")}) {
    EXPECT_THAT(log, Not(HasSubstr(secret)));
  }
}

}  // namespace
}  // namespace maploc::testing
