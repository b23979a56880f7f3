// The real binaries on the real data sets: import, serve, replay, read what they report.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mapstore/base/median.h"
#include "tests/support/files.h"
#include "tests/support/run_binary.h"
#include "tests/support/server_process.h"
#include "tests/support/shared_data.h"

namespace maploc::testing {

using nlohmann::json;

class RealDataTest : public ::testing::Test {
 protected:
  // Skips where the data set is not there.
  void Require(const std::string& set) {
    data_ = SharedDataFolder() / set;
    if (!std::filesystem::exists(data_ / "database.db")) {
      GTEST_SKIP() << "no real data: " << data_.string()
                   << " does not exist; set MAPLOC_SHARED_DATA to the folder that holds it";
    }
  }

  std::string Data(const std::string& name) const { return (data_ / name).string(); }
  const std::string& Address() const { return address_; }
  std::string Store() const { return folder_.File("store"); }

  // Runs one of the binaries with --json; a failure fails the test and gives null.
  // REQUIRES: no quotes in the arguments.
  json Run(const std::string& binary, const std::vector<std::string>& arguments) const {
    std::string command = binary;
    for (const std::string& argument : arguments) command += " '" + argument + "'";
    const Output run = RunBinary(command + " --json");
    EXPECT_EQ(run.exit_code, 0) << command << "\n" << run.error;
    return run.exit_code == 0 ? json::parse(run.out, nullptr, false) : json();
  }

  // From now on the store is served; the server before this one is ended first.
  void Serve(const std::string& store) {
    server_.Stop();
    address_ = server_.Start(store);
    ASSERT_NE(address_, "");
  }

  json Replay(const std::string& map, const std::string& session,
              const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"replay", "--server", address_,     "--map",
                                          map,      "--colmap", Data(session)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const json report = Run("maploc", arguments);
    if (report.is_object()) Print(session, report);
    return report;
  }

  // Segments by id: queries and localized queries, as maploc-map tells them.
  std::map<int, std::array<std::int64_t, 2>> SegmentCounts(const std::string& map) const {
    std::map<int, std::array<std::int64_t, 2>> counts;
    const json segments = Run("maploc-map", {"segments", "--store", Store(), "--map", map});
    for (const json& segment : segments) {
      counts[segment["segment"]] = {segment["queries"], segment["localized"]};
    }
    return counts;
  }

  static std::vector<json> Queries(const json& report) {
    return report["per_query"].get<std::vector<json>>();
  }
  static bool Within(const json& query, double metres, double degrees) {
    return query["outcome"] == "LOCALIZED" && query["translation_error_m"] <= metres &&
           query["rotation_error_deg"] <= degrees;
  }
  // All errors of a key, those of unanswered queries as infinity.
  static std::vector<double> Errors(const std::vector<json>& queries, const char* key) {
    std::vector<double> errors;
    for (const json& query : queries) {
      errors.push_back(query[key].is_null() ? HUGE_VAL : query[key].get<double>());
    }
    std::sort(errors.begin(), errors.end());
    return errors;
  }

  const TemporaryFolder folder_;
  // Records every query, which costs the other tests nothing that they look at.
  ServerProcess server_{folder_,
                        {"--recorder", folder_.File("recording"), "--recorder-every", "1"}};

 private:
  static void Print(const std::string& session, json report) {
    report.erase("per_query");
    std::cout << session << ": " << report.dump() << "\n";
  }

  std::filesystem::path data_;
  std::string address_;
};

}  // namespace maploc::testing
