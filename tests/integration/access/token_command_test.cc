// The binaries as an operator and a robot run them: tokens made, listed and revoked, and no secret
// where somebody else could read it.
#include <filesystem>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "mapstore/store/sqlite_store.h"
#include "tests/support/certificates.h"
#include "tests/support/run_binary.h"
#include "tests/support/server_process.h"

namespace maploc::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class TokenCommandTest : public ::testing::Test {
 protected:
  TokenCommandTest() { OpenSqliteStore(folder_.File("store")).value(); }

  Output Token(const std::string& arguments) const {
    return RunBinary("maploc-server token " + arguments + " --store " + folder_.File("store"));
  }
  // ID and token of a new one.
  Json Create(const std::string& arguments) const {
    const Output run = Token("create --json " + arguments);
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return Json::parse(run.out);
  }
  Json List() const { return Json::parse(Token("list --json").out); }
  static std::string Secret(const Json& created) {
    const auto token = created["token"].get<std::string>();
    return token.substr(token.rfind('-') + 1);
  }

  const TemporaryFolder folder_;
};

TEST_F(TokenCommandTest, AreMadeListedAndRevoked) {
  const Json made = Create("--role robot --robot rover --map yard --map 'the street'");
  Create("--role viewer");
  const std::string id = made["id"];
  Json listed = List();
  ASSERT_EQ(listed.size(), 2u);
  const Json robot = listed[0]["id"] == id ? listed[0] : listed[1];
  EXPECT_EQ(robot["role"], "robot");
  EXPECT_EQ(robot["robot"], "rover");
  EXPECT_EQ(robot["maps"], Json({"yard", "the street"}));
  EXPECT_TRUE(robot["revoked"].is_null());
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(Token("revoke --id " + id).exit_code, 0);
  }
  listed = List();
  const Json revoked = listed[0]["id"] == id ? listed[0] : listed[1];
  EXPECT_FALSE(revoked["revoked"].is_null());
}

TEST_F(TokenCommandTest, ATokenExpiresWhereItIsAskedTo) {
  const std::string forever = Create("--role viewer")["id"];
  Create("--role viewer --expires 90d");
  const Json listed = List();
  ASSERT_EQ(listed.size(), 2u);
  for (const Json& token : listed) EXPECT_EQ(token["expires"].is_null(), token["id"] == forever);
  EXPECT_THAT(Token("list").out, HasSubstr("never"));
  for (const char* wrong : {"90", "0d", "-1d", "d", "' d'", "soon", "99999999999999d", "1y"}) {
    EXPECT_EQ(Token("create --role viewer --expires " + std::string(wrong)).exit_code, 2) << wrong;
  }
}

TEST_F(TokenCommandTest, TheSecretIsShownOnceAndKeptNowhere) {
  const Output run = Token("create --role robot --robot rover");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const std::string token = run.out.substr(0, run.out.find('\n'));
  const std::string secret = token.substr(token.rfind('-') + 1);
  ASSERT_EQ(secret.size(), 64u);  // 256 bits
  EXPECT_THAT(run.error, Not(HasSubstr(secret)));
  EXPECT_THAT(folder_.Read("store-tokens"), Not(HasSubstr(secret)));
  EXPECT_THAT(Token("list").out, Not(HasSubstr(secret)));
  const fs::perms others = fs::perms::group_all | fs::perms::others_all;
  EXPECT_EQ(fs::status(folder_.File("store-tokens")).permissions() & others, fs::perms::none);
}

TEST_F(TokenCommandTest, WrongUsageIsTwoAndAFailureOne) {
  EXPECT_EQ(Token("").exit_code, 2);
  EXPECT_EQ(Token("create").exit_code, 2);
  EXPECT_EQ(Token("create --role king").exit_code, 2);
  EXPECT_EQ(Token("create --role robot").exit_code, 2);
  EXPECT_EQ(Token("create --role viewer --robot rover").exit_code, 2);
  ExpectFailed(Token("revoke --id 0123456789abcdef"), "TOKEN_NOT_FOUND");
  EXPECT_EQ(RunBinary("maploc-server token --help").exit_code, 0);
}

// The log at its most talkative, all that a client prints, and what `ps` shows.
TEST_F(TokenCommandTest, NoSecretIsInALogAnErrorOrAProcessList) {
  const Authority authority("maploc test");
  const Issued server_files = authority.Issue("IP:127.0.0.1");
  folder_.Write("ca.crt", authority.ca());
  folder_.Write("server.crt", server_files.cert);
  folder_.Write("server.key", server_files.key);
  const Json good = Create("--role robot --robot rover");
  const Json revoked = Create("--role viewer");
  Token("revoke --id " + revoked["id"].get<std::string>());
  folder_.Write("good", good["token"].get<std::string>() + "\n");
  folder_.Write("revoked", revoked["token"].get<std::string>() + "\n");
  folder_.Write("malformed", "open-sesame\n");
  ServerProcess server(folder_, {"--log-level", "debug", "--tls-cert", folder_.File("server.crt"),
                                 "--tls-key", folder_.File("server.key")});
  const std::string address = server.Start();
  const auto end_session = [&](const std::string& token) {
    return RunBinary("maploc end-session --session none --server " + address + " --ca " +
                     folder_.File("ca.crt") + " --token-file " + folder_.File(token));
  };

  std::string said;
  const auto expect = [&](const std::string& token, const std::string& reason) {
    const Output run = end_session(token);
    ExpectFailed(run, reason);
    said += run.out + run.error;
  };
  expect("good", "SESSION_NOT_FOUND");
  expect("revoked", "TOKEN_REVOKED");
  expect("malformed", "TOKEN_MALFORMED");
  said += ReadFile("/proc/" + std::to_string(server.pid()) + "/cmdline");
  server.Stop();
  said += folder_.Read("stderr");

  const std::string key_line = server_files.key.substr(server_files.key.find('\n') + 1, 40);
  for (const std::string& secret :
       {Secret(good), Secret(revoked), std::string("open-sesame"), key_line}) {
    EXPECT_THAT(said, Not(HasSubstr(secret)));
  }
}

TEST_F(TokenCommandTest, TheTokenAlsoComesFromTheEnvironment) {
  const Json good = Create("--role robot --robot rover");
  ServerProcess server(folder_);
  const std::string command = "maploc end-session --session none --server " + server.Start();
  setenv("MAPLOC_TOKEN", good["token"].get<std::string>().c_str(), 1);
  ExpectFailed(RunBinary(command), "SESSION_NOT_FOUND");
  unsetenv("MAPLOC_TOKEN");
  ExpectFailed(RunBinary(command), "TOKEN_MISSING");
}

TEST_F(TokenCommandTest, AServerThatWouldBeOpenToAllIsOneLineAndExitOne) {
  ExpectFailed(RunBinary("maploc-server --listen 0.0.0.0:0 --store " + folder_.File("fresh")),
               "--insecure");
  EXPECT_FALSE(fs::exists(folder_.File("fresh")));
}

}  // namespace
}  // namespace maploc::testing
