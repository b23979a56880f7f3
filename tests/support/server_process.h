// The real maploc-server as a process, on a port of the system's choice.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/files.h"
#include "tests/support/process.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {

// Serves `store`; the port goes into the folder's file "port".
inline std::vector<std::string> ServerCommand(const TemporaryFolder& folder,
                                              const std::string& store) {
  return {std::string(MAPLOC_BIN_DIR) + "/maploc-server",
          "--store",
          store,
          "--listen",
          "127.0.0.1:0",
          "--port-file",
          folder.File("port")};
}

// HOST:PORT as soon as a server serves. Where it never does the test fails, with what the server
// wrote to the folder's file "stderr", and this is "".
inline std::string WaitForAddress(const TemporaryFolder& folder) {
  if (!WaitFor([&] { return std::filesystem::exists(folder.File("port")); })) {
    ADD_FAILURE() << "the server does not serve: " << folder.Read("stderr");
    return "";
  }
  const std::string port = folder.Read("port");
  return "127.0.0.1:" + port.substr(0, port.find('\n'));
}

// As often as a test starts it; killed with this object.
class ServerProcess {
 public:
  // Keeps the port file and the log in `folder`, and the store too unless said otherwise.
  explicit ServerProcess(const TemporaryFolder& folder, std::vector<std::string> more_flags = {})
      : folder_(folder), more_flags_(std::move(more_flags)) {}

  // Returns when it serves; HOST:PORT.
  std::string Start() { return Start(folder_.File("store")); }
  std::string Start(const std::string& store) {
    std::filesystem::remove(folder_.File("port"));  // a killed server leaves its own behind
    Launch(store);
    return WaitForAddress(folder_);
  }
  // Does not wait until it serves.
  void Launch() { Launch(folder_.File("store")); }
  void Launch(const std::string& store) {
    std::vector<std::string> command = ServerCommand(folder_, store);
    command.insert(command.end(), more_flags_.begin(), more_flags_.end());
    process_ = std::make_unique<Process>(std::move(command), folder_.File("stderr"));
  }
  pid_t pid() const { return process_->pid(); }
  // kill -9; returns when the process is gone.
  void Kill() { End(SIGKILL, -1); }
  // Returns when it has ended of itself; 1: it says that statistics are not on disk. Without a
  // server nothing happens.
  void Stop(int exit_code = 0) {
    if (process_ != nullptr) End(SIGTERM, exit_code);
  }
  // As Stop, where the store was taken away: the last line says that statistics are lost.
  void StopWithoutStore() {
    End(SIGTERM, 1);
    const std::string log = folder_.Read("stderr");
    const std::string last = log.substr(log.rfind('\n', log.size() - 2) + 1);
    EXPECT_TRUE(last.starts_with("maploc-server: statistics are not on disk: ")) << log;
  }

 private:
  void End(int signal, int exit_code) {
    process_->Signal(signal);
    EXPECT_EQ(process_->Wait(), exit_code) << folder_.Read("stderr");
    process_.reset();
  }

  const TemporaryFolder& folder_;
  const std::vector<std::string> more_flags_;
  std::unique_ptr<Process> process_;
};

}  // namespace maploc::testing
