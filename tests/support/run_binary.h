// The project's binaries, run as a script runs them.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <sys/wait.h>

#include "tests/support/files.h"

namespace maploc::testing {

struct Output {
  int exit_code = -1;  // of the shell: 128 + n where signal n ended the binary
  std::string out;
  std::string error;  // what it wrote to standard error
};

// `command` begins with a binary's name; the shell reads it, quotes and all. REQUIRES: no
// redirections in it.
inline Output RunBinary(const std::string& command) {
  const TemporaryFolder folder;
  const std::string line = std::string(MAPLOC_BIN_DIR) + "/" + command + " >" + folder.File("out") +
                           " 2>" + folder.File("error");
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, folder.Read("out"), folder.Read("error")};
}

// Exit code 1, one line on standard error that holds `cause`, nothing on standard output.
inline void ExpectFailed(const Output& run, const std::string& cause) {
  EXPECT_EQ(run.exit_code, 1) << run.error;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.error, ::testing::HasSubstr(cause));
  EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
}

}  // namespace maploc::testing
