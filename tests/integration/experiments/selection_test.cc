// `maploc-experiments selection` as scripts see it.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

namespace maploc::testing {
namespace {

struct Output {
  int exit_code = -1;
  std::string out;
};

Output RunSelectionCommand(const std::string& arguments) {
  const std::string command =
      std::string(MAPLOC_BIN_DIR) + "/maploc-experiments selection " + arguments;
  Output run;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    run.out.append(buffer.data(), n);
  }
  run.exit_code = WEXITSTATUS(pclose(pipe));
  return run;
}

void ExpectShares(const nlohmann::json& shares) {
  for (const auto& [method, share] : shares.items()) {
    EXPECT_GE(share.get<double>(), 0.0) << method;
    EXPECT_LE(share.get<double>(), 1.0) << method;
  }
}

TEST(SelectionCommand, JsonHasTheContractsShape) {
  const Output run = RunSelectionCommand("--queries 4 --trials 1 --json");
  ASSERT_EQ(run.exit_code, 0);
  const nlohmann::json document = nlohmann::json::parse(run.out, nullptr, false);
  ASSERT_TRUE(document.is_object()) << run.out;
  ASSERT_GE(document["sessions"].size(), 5u);
  for (const nlohmann::json& session : document["sessions"]) {
    EXPECT_TRUE(session["left_out"].is_string());
    ExpectShares(session["auc"]);
    for (const char* method :
         {"1p1l-4dof", "1p1l-6dof", "1p1l-auto", "2p-4dof", "2p-6dof", "2p-auto", "mixed-4dof",
          "mixed-6dof", "mixed-auto", "p3p", "epnp", "selection"}) {
      EXPECT_TRUE(session["auc"].contains(method)) << method;
      EXPECT_EQ(session["recall"][method].size(), 4u) << method;
    }
  }
  const nlohmann::json& whole = document["whole"];
  ExpectShares(whole["auc"]);
  for (const char* key : {"mean_iterations", "mean_ms"}) {
    for (const char* method : {"1p1l-auto", "2p-auto", "mixed-auto", "p3p", "selection"}) {
      EXPECT_GT(whole[key][method].get<double>(), 0.0) << key << " " << method;
    }
  }
}

TEST(SelectionCommand, AFolderWithoutSessionsFailsInOneLine) {
  const std::string folder = ::testing::TempDir() + "selection_without_sessions";
  std::filesystem::create_directories(folder);
  for (const std::string& set : {folder, folder + "/missing"}) {
    const Output run = RunSelectionCommand("--set " + set + " 2>&1");
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_NE(run.out.find(set), std::string::npos) << run.out;
    EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 1) << run.out;
  }
  std::filesystem::remove_all(folder);
}

TEST(SelectionCommand, WhatMakesNoSenseIsRefused) {
  EXPECT_EQ(RunSelectionCommand("--trials 0 2>&1").exit_code, 1);
  EXPECT_EQ(RunSelectionCommand("--trials many 2>&1").exit_code, 2);
  EXPECT_EQ(RunSelectionCommand("--methods magic 2>&1").exit_code, 2);
}

}  // namespace
}  // namespace maploc::testing
