// The real maploc-server on a store, as often as a test starts it; each time on a port of the
// system's choice.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/contract/store/store_fixture.h"
#include "tests/support/process.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {

class ServerProcess {
 public:
  // Keeps the store, the port file and the log in `folder`.
  explicit ServerProcess(const TemporaryFolder& folder) : folder_(folder) {}

  // Returns when it serves; HOST:PORT.
  std::string Start() {
    std::filesystem::remove(folder_.File("port"));  // a killed server leaves its own behind
    Launch();
    EXPECT_TRUE(WaitFor([this] { return std::filesystem::exists(folder_.File("port")); }))
        << Read("stderr");
    std::string port = Read("port");
    if (!port.empty()) port.pop_back();
    return "127.0.0.1:" + port;
  }
  // Does not wait until it serves.
  void Launch() {
    process_ = std::make_unique<Process>(
        std::vector<std::string>{std::string(MAPLOC_BIN_DIR) + "/maploc-server", "--store",
                                 folder_.File("store"), "--listen", "127.0.0.1:0", "--port-file",
                                 folder_.File("port"), "--queue", "64", "--log-level", "warn"},
        folder_.File("stderr"));
  }
  // kill -9; returns when the process is gone.
  void Kill() {
    process_->Signal(SIGKILL);
    EXPECT_EQ(process_->Wait(), -1) << "the server had ended by itself: " << Read("stderr");
    process_.reset();
  }

 private:
  std::string Read(const std::string& name) const {
    std::ifstream file(folder_.File(name));
    return {std::istreambuf_iterator<char>(file), {}};
  }

  const TemporaryFolder& folder_;
  std::unique_ptr<Process> process_;
};

}  // namespace maploc::testing
