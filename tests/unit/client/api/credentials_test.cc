// Files of credentials: what is wrong with them is said before any call, and by the file's name.
#include "client/api/credentials.h"

#include <gmock/gmock.h>

#include "tests/support/files.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

class CredentialsTest : public ::testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text) const {
    folder_.Write(name, text);
    return folder_.File(name);
  }
  static std::string Refusal(const CredentialFiles& files) {
    const Status status = ReadCredentials(files).status();
    EXPECT_EQ(status.reason(), "CREDENTIALS_INVALID");
    return status.message();
  }

  const TemporaryFolder folder_;
};

TEST_F(CredentialsTest, ATokenIsTheFilesOneLine) {
  CredentialFiles files;
  files.token = Write("token", "maploc-1-2\r\n");
  EXPECT_EQ(ReadCredentials(files)->token, "maploc-1-2");
  for (const char* text : {"", "\n", "two\nlines\n", "two words\n", "caf\xc3\xa9\n"}) {
    files.token = Write("token", text);
    EXPECT_THAT(Refusal(files), HasSubstr(files.token)) << text;
  }
  files.token = Write("token", std::string(5000, 'x'));
  Refusal(files);
  files.token = folder_.File("missing");
  EXPECT_THAT(Refusal(files), HasSubstr("No such file"));
}

TEST_F(CredentialsTest, FilesThatAreMixedUpOrMissingAreRefused) {
  const std::string cert = Write("cert", "-----BEGIN CERTIFICATE-----\n");
  const std::string key = Write("key", "-----BEGIN EC PRIVATE KEY-----\n");
  EXPECT_TRUE(ReadCredentials({cert, cert, key, ""}).ok());
  EXPECT_THAT(Refusal({key, "", "", ""}), HasSubstr(key));
  EXPECT_THAT(Refusal({cert, key, cert, ""}), HasSubstr(key));
  EXPECT_THAT(Refusal({cert, cert, "", ""}), HasSubstr("--key"));
  EXPECT_THAT(Refusal({"", cert, key, ""}), HasSubstr("--ca"));
}

}  // namespace
}  // namespace maploc::testing
