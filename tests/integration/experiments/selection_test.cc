// `maploc-experiments selection` as scripts see it.
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/files.h"
#include "tests/support/run_binary.h"

namespace maploc::testing {
namespace {

Output RunSelectionCommand(const std::string& arguments) {
  return RunBinary("maploc-experiments selection " + arguments);
}

void ExpectShares(const nlohmann::json& shares) {
  for (const auto& [method, share] : shares.items()) {
    EXPECT_GE(share.get<double>(), 0.0) << method;
    EXPECT_LE(share.get<double>(), 1.0) << method;
  }
}

TEST(SelectionCommand, JsonHasTheContractsShape) {
  const Output run = RunSelectionCommand("--queries 4 --trials 1 --json");
  ASSERT_EQ(run.exit_code, 0) << run.error;
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
  const TemporaryFolder folder;
  for (const std::string& set : {folder.path(), folder.File("missing")}) {
    SCOPED_TRACE(set);
    ExpectFailed(RunSelectionCommand("--set " + set), set);
  }
}

TEST(SelectionCommand, WhatMakesNoSenseIsRefused) {
  EXPECT_EQ(RunSelectionCommand("--trials 0").exit_code, 1);
  EXPECT_EQ(RunSelectionCommand("--trials many").exit_code, 2);
  EXPECT_EQ(RunSelectionCommand("--methods magic").exit_code, 2);
}

}  // namespace
}  // namespace maploc::testing
