// maploc-server --check-config: what a start would use and refuse, without starting.
#include <cstdlib>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "mapstore/store/sqlite_store.h"
#include "tests/support/certificates.h"
#include "tests/support/files.h"
#include "tests/support/run_binary.h"
#include "tests/support/server_process.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

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

}  // namespace
}  // namespace maploc::testing
