// The made-up campus behind the real server, for the real `maploc`.
#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/files.h"
#include "tests/support/run_binary.h"
#include "tests/support/server_process.h"

namespace maploc::testing {

// One campus, imported and served, for all tests of a suite.
class CampusTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    server_ = std::make_unique<ServerProcess>(*folder_);
    const std::string campus = folder_->File("campus");
    const Output written = RunBinary("maploc simulate --write-world " + campus);
    ASSERT_EQ(written.exit_code, 0) << written.error;
    const Output imported = RunBinary("maploc-map import-colmap --store " + folder_->File("store") +
                                      " --map campus --model " + campus + "/model --database " +
                                      campus + "/database.db --descriptors orb --lines " + campus +
                                      "/lines.txt --gravity 0,0,-1 --scale 1 --segment-length 45");
    ASSERT_EQ(imported.exit_code, 0) << imported.error;
    server_address_ = server_->Start();
    ASSERT_NE(server_address_, "");
  }
  static void TearDownTestSuite() {
    server_.reset();
    folder_.reset();
  }

  static std::string At() { return " --server " + server_address_ + " "; }
  static std::string Store() { return folder_->File("store"); }
  static std::string Replay() {
    return "maploc replay" + At() + "--map campus --colmap " + Campus("model") + " --database " +
           Campus("database.db") + " ";
  }
  static std::string Campus(const std::string& file) { return folder_->File("campus/" + file); }

  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline std::unique_ptr<ServerProcess> server_;
  static inline std::string server_address_;
};

}  // namespace maploc::testing
