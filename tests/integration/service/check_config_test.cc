// maploc-server --check-config: what a start would use and refuse, without starting.
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include "mapstore/store/sqlite_store.h"
#include "tests/support/certificates.h"
#include "tests/support/files.h"
#include "tests/support/run_binary.h"
#include "tests/support/server_process.h"

namespace maploc::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

// Root may write everywhere.
class AsNobody {
 public:
  AsNobody() { EXPECT_TRUE(!was_root_ || setresuid(65534, 65534, 0) == 0); }
  ~AsNobody() { EXPECT_TRUE(!was_root_ || setresuid(0, 0, 0) == 0); }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;

 private:
  const bool was_root_ = geteuid() == 0;
};

class CheckConfigTest : public ::testing::Test {
 protected:
  CheckConfigTest() { EXPECT_TRUE(OpenSqliteStore(store_).ok()); }
  ~CheckConfigTest() override { unsetenv("MAPLOC_WORKERS"); }

  static Output Check(const std::string& flags) {
    return RunBinary("maploc-server --check-config " + flags);
  }
  std::string Config(const std::string& text) const {
    folder_.Write("server.toml", text);
    return folder_.File("server.toml");
  }
  // {value, from} of an option.
  static std::pair<std::string, std::string> Of(const Json& document, const std::string& option) {
    for (const Json& one : document.at("options")) {
      if (one.at("option") == option) return {one.at("value"), one.at("from")};
    }
    return {};
  }

  using Told = std::pair<std::string, std::string>;
  const TemporaryFolder folder_;
  const std::string store_ = folder_.File("store");
};

TEST_F(CheckConfigTest, TellsEachOptionAndWhereItComesFrom) {
  const std::string config = Config("workers = 2\nqueue = 5\nlog-level = \"warn\"\n");
  setenv("MAPLOC_WORKERS", "3", 1);
  const Output run = Check("--json --config " + config +
                           " --insecure --cache-bytes 1MiB --queue=7 --store " + store_);
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(run.error, "");
  const Json told = Json::parse(run.out);
  EXPECT_THAT(told.at("faults"), IsEmpty());
  EXPECT_EQ(Of(told, "--store"), Told(store_, "flag"));
  EXPECT_EQ(Of(told, "--queue"), Told("7", "flag"));
  EXPECT_EQ(Of(told, "--insecure"), Told("true", "flag"));
  EXPECT_EQ(Of(told, "--cache-bytes"), Told("1048576", "flag"));
  EXPECT_EQ(Of(told, "--workers"), Told("3", "environment"));
  EXPECT_EQ(Of(told, "--log-level"), Told("warn", "file"));
  EXPECT_EQ(Of(told, "--listen"), Told("127.0.0.1:50051", "default"));
}

TEST_F(CheckConfigTest, TellsEveryFaultOfTheCommandLine) {
  const std::string config = Config("quue = 5\nlog-format = \"xml\"\n");
  setenv("MAPLOC_WORKERS", "many", 1);
  const Output run =
      Check("--config " + config + " --listen 99999 --min-confidence 2 --nonsense --tls-cert c");
  EXPECT_EQ(run.exit_code, 1);
  for (const char* fault : {"quue", "--log-format", "--workers", "--listen", "--min-confidence",
                            "--nonsense", "--store is required", "--tls-cert requires --tls-key"}) {
    EXPECT_THAT(run.error, HasSubstr(fault));
  }
}

TEST_F(CheckConfigTest, TellsEveryFaultOfWhatTheOptionsName) {
  const Issued other = Authority("other").Issue("IP:127.0.0.1");
  const Issued expired = Authority("maploc").Issue("IP:127.0.0.1", kExpired);
  folder_.Write("server.crt", expired.cert);
  folder_.Write("server.key", other.key);
  folder_.Write("no-store", "this is no store");
  folder_.Write("no-store-tokens", "this is no token\n");
  const Output run =
      Check("--store " + folder_.File("no-store") + " --listen no.such.host.invalid:1 --tls-cert " +
            folder_.File("server.crt") + " --tls-key " + folder_.File("server.key") +
            " --tls-client-ca " + folder_.File("missing.crt"));
  EXPECT_EQ(run.exit_code, 1);
  for (const char* fault : {"INVALID_FILE", "no-store-tokens", "UNKNOWN_HOST",
                            "TLS_CERTIFICATE_EXPIRED", "TLS_KEY_MISMATCH", "TLS_FILE_UNREADABLE"}) {
    EXPECT_THAT(run.error, HasSubstr(fault));
  }
}

TEST_F(CheckConfigTest, AFileThatIsMissingDoesNotHideTheRest) {
  const Output run = Check("--config missing.toml --workers many --store " + store_);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.error, HasSubstr("missing.toml"));
  EXPECT_THAT(run.error, HasSubstr("--workers"));
}

TEST_F(CheckConfigTest, WhoeverCouldBeReachedInTheClearIsAFault) {
  EXPECT_THAT(Check("--listen 0.0.0.0:1 --store " + store_).error, HasSubstr("INSECURE"));
  EXPECT_EQ(Check("--listen 0.0.0.0:1 --insecure --store " + store_).exit_code, 0);
}

TEST_F(CheckConfigTest, BesideARunningServerItAnswersAndChangesNothing) {
  ServerProcess server(folder_);
  const std::string address = server.Start();
  const std::string bytes = ReadFile(store_);
  EXPECT_EQ(Check("--store " + store_ + " --listen " + address).exit_code, 0);
  EXPECT_EQ(ReadFile(store_), bytes);
  server.Stop();
}

TEST_F(CheckConfigTest, AStoreThatIsToBeMadeIsNotMade) {
  EXPECT_EQ(Check("--store " + folder_.File("fresh")).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_.File("fresh")));
  EXPECT_THAT(Check("--store " + folder_.File("no/folder/store")).error, HasSubstr("make it"));
}

TEST_F(CheckConfigTest, WhatAStartWouldMakeMustHaveAFolderThatMayBeWritten) {
  EXPECT_THAT(Check("--port-file /nonexistent/port --store " + store_).error,
              AllOf(HasSubstr("--port-file"), HasSubstr("FOLDER_NOT_FOUND")));
  std::filesystem::create_directory(folder_.File("closed"));
  chmod(folder_.File("closed").c_str(), 0555);
  chmod(folder_.path().c_str(), 0755);
  const AsNobody nobody;
  EXPECT_THAT(Check("--store " + folder_.File("closed/store")).error, HasSubstr("CANNOT_WRITE"));
}

TEST_F(CheckConfigTest, TwoListenersOnOneAddressAreAFault) {
  const std::string check = "--insecure --store " + store_ + " --listen 127.0.0.1:50991 ";
  for (const char* same : {"127.0.0.1:50991", "localhost:50991", "0.0.0.0:50991"}) {
    EXPECT_THAT(Check(check + "--metrics-listen " + same).error, HasSubstr("SAME_ADDRESS"));
  }
  EXPECT_EQ(Check(check + "--metrics-listen 127.0.0.1:50992").exit_code, 0);
  EXPECT_EQ(
      Check("--store " + store_ + " --listen 127.0.0.1:0 --metrics-listen 127.0.0.1:0").exit_code,
      0);
}

TEST_F(CheckConfigTest, AnAuthorityThatHasExpiredAndAPipeAreFaults) {
  const Authority authority("maploc");
  const Issued server = authority.Issue("IP:127.0.0.1");
  const std::string expired = authority.Issue("IP:127.0.0.1", kExpired).cert;
  folder_.Write("server.crt", server.cert);
  folder_.Write("server.key", server.key);
  folder_.Write("expired.crt", expired);
  folder_.Write("both.crt", expired + authority.ca());
  const std::string check = "--store " + store_ + " --tls-key " + folder_.File("server.key");
  const std::string good = check + " --tls-cert " + folder_.File("server.crt");
  EXPECT_THAT(Check(good + " --tls-client-ca " + folder_.File("expired.crt")).error,
              HasSubstr("TLS_CERTIFICATE_EXPIRED"));
  EXPECT_EQ(Check(good + " --tls-client-ca " + folder_.File("both.crt")).exit_code, 0);
  ASSERT_EQ(mkfifo(folder_.File("pipe").c_str(), 0600), 0);
  EXPECT_THAT(Check(check + " --tls-cert " + folder_.File("pipe")).error, HasSubstr("is a pipe"));
}

}  // namespace
}  // namespace maploc::testing
