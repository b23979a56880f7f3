// The binary itself, run as a script would.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <sys/wait.h>

#include "tests/contract/store/store_fixture.h"

namespace maploc::testing {

struct Output {
  int exit_code = -1;
  std::string out;
  std::string error;
};

// Through the shell. The words on standard error pass through a file in `folder`.
inline Output RunMaplocMap(const std::string& arguments, const TemporaryFolder& folder) {
  const std::string errors = folder.File("stderr");
  const std::string command =
      std::string(MAPLOC_BIN_DIR) + "/maploc-map " + arguments + " 2>" + errors;
  Output run;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    run.out.append(buffer.data(), n);
  }
  run.exit_code = WEXITSTATUS(pclose(pipe));
  std::ifstream file(errors);
  run.error = {std::istreambuf_iterator<char>(file), {}};
  return run;
}

// Exit code 1, one line on standard error that holds `cause`, nothing on standard output.
inline void ExpectFailed(const Output& run, const std::string& cause) {
  EXPECT_EQ(run.exit_code, 1) << run.error;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.error, ::testing::HasSubstr(cause));
  EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
}

}  // namespace maploc::testing
