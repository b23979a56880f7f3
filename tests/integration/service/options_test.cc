// Built-in defaults < configuration file < environment < flag.
#include "server/app/options.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/support/files.h"

namespace maploc::testing {
namespace {

class OptionsTest : public ::testing::Test {
 protected:
  ~OptionsTest() override {
    unsetenv("MAPLOC_LISTEN");
    unsetenv("MAPLOC_INSECURE");
    unsetenv("MAPLOC_PORT_FILE");
  }

  static CommandLine Parse(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "maploc-server");
    return ParseCommandLine(static_cast<int>(arguments.size()), arguments.data());
  }
  std::string Config(const std::string& text) const {
    folder_.Write("config.toml", text);
    return folder_.File("config.toml");
  }

  const TemporaryFolder folder_;
};

TEST_F(OptionsTest, TheNearerOneWins) {
  const std::string config = Config("store = \"from-file\"\nlisten = \"file:1\"\nworkers = 3\n");
  EXPECT_EQ(Parse({"--store", "s"}).options.listen, "127.0.0.1:50051");
  EXPECT_EQ(Parse({"--config", config.c_str()}).options.store, "from-file");
  EXPECT_EQ(Parse({"--config", config.c_str()}).options.workers, 3);
  EXPECT_EQ(Parse({"--config", config.c_str()}).options.listen, "file:1");
  setenv("MAPLOC_LISTEN", "environment:2", 1);
  EXPECT_EQ(Parse({"--config", config.c_str()}).options.listen, "environment:2");
  EXPECT_EQ(Parse({"--config", config.c_str(), "--listen", "flag:3"}).options.listen, "flag:3");
}

TEST_F(OptionsTest, SizesMayHaveUnits) {
  const auto bytes = [](const char* size) {
    return Parse({"--store", "s", "--cache-bytes", size}).options.cache_bytes;
  };
  EXPECT_EQ(bytes("1234"), 1234);
  EXPECT_EQ(bytes("512MiB"), 512ll << 20);
  EXPECT_EQ(bytes("3GB"), 3'000'000'000);
  EXPECT_EQ(Parse({"--store", "s"}).options.cache_bytes, 0);
  for (const char* size : {"much", "-1", "1.5GB", "5 parsecs", "99999999999999999999"}) {
    EXPECT_EQ(Parse({"--store", "s", "--cache-bytes", size}).exit_code, 2) << size;
  }
}

TEST_F(OptionsTest, AFlagWithoutAValueIsReadFromTheEnvironmentToo) {
  EXPECT_FALSE(Parse({"--store", "s"}).options.insecure);
  setenv("MAPLOC_INSECURE", "true", 1);
  EXPECT_TRUE(Parse({"--store", "s"}).options.insecure);
  setenv("MAPLOC_INSECURE", "false", 1);
  EXPECT_FALSE(Parse({"--store", "s"}).options.insecure);
}

// As a compose file sets one that is left out. Taken as "--port-file=", CLI11 would read the next
// argument for its value.
TEST_F(OptionsTest, AnEmptyVariableIsNone) {
  setenv("MAPLOC_PORT_FILE", "", 1);
  setenv("MAPLOC_LISTEN", "", 1);
  const CommandLine line = Parse({"--insecure", "--store", "s"});
  EXPECT_FALSE(line.exit_code.has_value());
  EXPECT_TRUE(line.options.insecure);
  EXPECT_EQ(line.options.store, "s");
  EXPECT_EQ(line.options.port_file, "");
  EXPECT_EQ(line.options.listen, "127.0.0.1:50051");
}

TEST_F(OptionsTest, WrongUsageIsTwoAndUnusableFilesAreOne) {
  EXPECT_EQ(Parse({}).exit_code, 2);
  EXPECT_EQ(Parse({"--store", "s", "--nonsense"}).exit_code, 2);
  EXPECT_EQ(Parse({"--store", "s", "--workers", "many"}).exit_code, 2);
  for (const char* flag : {"--idle-timeout", "--max-error", "--min-confidence"}) {
    EXPECT_EQ(Parse({"--store", "s", flag, "nan"}).exit_code, 2) << flag;
    EXPECT_EQ(Parse({"--store", "s", flag, "-1"}).exit_code, 2) << flag;
  }
  EXPECT_EQ(Parse({"--store", "s", "--listen", "localhost"}).exit_code, 2);
  EXPECT_EQ(Parse({"--store", "s", "--tls-cert", "c"}).exit_code, 2);
  EXPECT_EQ(Parse({"--store", "s", "--tls-client-ca", "c"}).exit_code, 2);
  EXPECT_EQ(Parse({"--store", "s", "--listen", "localhost:65536"}).exit_code, 2);
  EXPECT_EQ(Parse({"--store", "s", "--config", "missing.toml"}).exit_code, 1);
  EXPECT_EQ(Parse({"--store", "s", "--config", Config("nonsense = 1\n").c_str()}).exit_code, 1);
  EXPECT_EQ(Parse({"--help"}).exit_code, 0);
  EXPECT_EQ(Parse({"--store", "s"}).exit_code, std::nullopt);
}

}  // namespace
}  // namespace maploc::testing
