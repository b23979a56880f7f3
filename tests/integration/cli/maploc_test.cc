// The real binaries, as a script uses them: exit codes, JSON and messages of `maploc`.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace maploc {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string kBin = MAPLOC_BIN_DIR;

std::string ReadFile(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

struct Outcome {
  int code;
  std::string out;
  std::string err;
};

// One campus, imported and served, for all tests of this file.
class MaplocTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    dir_ = fs::path(::testing::TempDir()) / "maploc_cli";
    fs::remove_all(dir_);
    fs::create_directories(dir_);
    const std::string campus = dir_ / "campus";
    ASSERT_EQ(Run("maploc simulate --write-world " + campus).code, 0);
    const Outcome imported =
        Run("maploc-map import-colmap --store " + (dir_ / "store.db").string() +
            " --map campus --model " + campus + "/model --database " + campus +
            "/database.db --descriptors orb --lines " + campus +
            "/lines.txt --gravity 0,0,-1 --scale 1 --segment-length 45");
    ASSERT_EQ(imported.code, 0) << imported.err;
    const fs::path port = dir_ / "port";
    server_ = new testing::Process({kBin + "/maploc-server", "--store", dir_ / "store.db",
                                    "--listen", "127.0.0.1:0", "--port-file", port},
                                   dir_ / "server.log");
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (ReadFile(port).empty() && std::chrono::steady_clock::now() < give_up) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    server_address_ = "127.0.0.1:" + ReadFile(port);
    while (server_address_.ends_with('\n')) server_address_.pop_back();
  }
  static void TearDownTestSuite() {
    delete server_;
    fs::remove_all(dir_);
  }

  // `command` begins with a binary's name.
  static Outcome Run(const std::string& command) {
    const fs::path out = dir_ / "out";
    const fs::path err = dir_ / "err";
    const int status =
        std::system((kBin + "/" + command + " >" + out.string() + " 2>" + err.string()).c_str());
    return {WEXITSTATUS(status), ReadFile(out), ReadFile(err)};
  }
  static std::string At() { return " --server " + server_address_ + " "; }
  static std::string Campus(const std::string& file) { return (dir_ / "campus" / file).string(); }

  static inline fs::path dir_;
  static inline std::string server_address_;
  static inline testing::Process* server_ = nullptr;
};

TEST_F(MaplocTest, WrongUsageIsTwoAndHelpShowsAnExample) {
  EXPECT_EQ(Run("maploc").code, 2);
  EXPECT_EQ(Run("maploc fly").code, 2);
  EXPECT_EQ(Run("maploc replay --server 127.0.0.1:1").code, 2);
  EXPECT_EQ(Run("maploc end-session --session x --bogus").code, 2);
  EXPECT_EQ(Run("maploc replay --server a:1 --map m --colmap d --strategy 3p").code, 2);
  EXPECT_EQ(Run("maploc replay --server a:1 --map m --colmap d --label season").code, 2);
  EXPECT_EQ(Run("maploc localize --server a:1 --map m --image i --camera c --gravity 0,1").code, 2);
  EXPECT_EQ(Run("maploc load --server a:1 --map m --colmap d --robots many").code, 2);
  for (const char* command : {"localize", "replay", "end-session", "load", "simulate"}) {
    const Outcome help = Run(std::string("maploc ") + command + " --help");
    EXPECT_EQ(help.code, 0);
    EXPECT_THAT(help.out, HasSubstr(std::string("  maploc ") + command));
  }
}

TEST_F(MaplocTest, AFailureIsOneAndOneLine) {
  const std::string load = "load" + At() + "--map campus --colmap " + Campus("model") +
                           " --database " + Campus("database.db") + " ";
  const std::vector<std::string> commands = {
      "localize" + At() + "--map campus --image i.png --camera c.txt --gravity 0,0,0",
      "localize" + At() + "--map campus --image i.png --camera absent.txt --gravity 0,1,0",
      "replay" + At() + "--map nowhere --colmap " + Campus("model"),
      "replay" + At() + "--map campus --colmap absent --database " + Campus("database.db"),
      "replay" + At() + "--map campus --colmap " + Campus("model"),
      "end-session" + At() + "--session unknown",
      "end-session --server 127.0.0.1:1 --session unknown",
      "simulate --map campus",
      "simulate" + At() + "--map campus --robots 0",
      "simulate" + At() + "--map campus --queries -1",
      load + "--robots 0",
      load + "--robots -1",
      load + "--seconds -1",
      load + "--seconds nan",
      load + "--seconds inf",
      load + "--rate nan",
      load + "--rate -1",
      load + "--rate 1e300",
      load + "--session-queries 0",
  };
  for (const std::string& command : commands) {
    const Outcome failed = Run("maploc " + command);
    EXPECT_EQ(failed.code, 1) << command;
    EXPECT_EQ(failed.out, "") << command;
    EXPECT_EQ(std::count(failed.err.begin(), failed.err.end(), '\n'), 1) << failed.err;
    EXPECT_THAT(failed.err, HasSubstr("maploc: ")) << command;
  }
}

TEST_F(MaplocTest, AReplayLocalizesAndReportsWhatScriptsRelyOn) {
  const Outcome replay =
      Run("maploc replay" + At() + "--map campus --colmap " + Campus("model") + " --database " +
          Campus("database.db") + " --gravity-noise-deg 0.5 --label season=summer --json");
  ASSERT_EQ(replay.code, 0) << replay.err;
  const Json json = Json::parse(replay.out);
  EXPECT_EQ(json["queries"], 180);
  EXPECT_GE(json["localized"].get<int>(), 175);
  EXPECT_EQ(json["wrong"], 0);
  EXPECT_LT(json["median_translation_error_m"].get<double>(), 0.05);
  EXPECT_EQ(json["recall"].size(), 4u);
  EXPECT_GT(json["recall"]["0.25m_2deg"].get<double>(), 0.95);
  EXPECT_GT(json["auc"].get<double>(), 0.9);
  EXPECT_GT(json["latency_ms"]["p99"].get<double>(), 0.0);
  ASSERT_EQ(json["per_query"].size(), 180u);
  for (const char* key :
       {"name", "outcome", "translation_error_m", "rotation_error_deg", "segment", "strategy",
        "iterations", "point_matches", "point_inliers", "line_matches", "line_inliers",
        "confidence", "server_ms", "latency_ms"}) {
    EXPECT_TRUE(json["per_query"][0].contains(key)) << key;
  }
  for (const Json& query : json["per_query"]) {
    EXPECT_EQ(query["translation_error_m"].is_null(), query["outcome"] != "LOCALIZED");
  }

  const std::string end =
      "maploc end-session" + At() + "--json --session " + json["session"].get<std::string>();
  const Outcome once = Run(end);
  const Outcome twice = Run(end);
  EXPECT_EQ(once.code, 0) << once.err;
  EXPECT_EQ(once.out, twice.out);
  EXPECT_EQ(Json::parse(once.out)["queries"], 180);
}

TEST_F(MaplocTest, ManyRobotsAtOnceAreReported) {
  const std::string load = "maploc load" + At() + "--map campus --colmap " + Campus("model") +
                           " --database " + Campus("database.db") +
                           " --gravity-noise-deg 0.5 --robots 4 --session-queries 5 --json ";
  const Outcome run = Run(load + "--seconds 1");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  int answers = 0;
  for (const auto& [outcome, count] : json["outcomes"].items()) answers += count.get<int>();
  for (const auto& [code, count] : json["errors"].items()) answers += count.get<int>();
  EXPECT_GT(json["outcomes"]["LOCALIZED"].get<int>(), 0);
  EXPECT_EQ(json["requests"], answers);
  EXPECT_GT(json["per_second"].get<double>(), 0.0);
  EXPECT_GE(json["sessions"].get<int>(), 4);
  for (const char* key : {"p50", "p95", "p99"}) {
    EXPECT_GT(json["latency_ms"][key].get<double>(), 0.0) << key;
  }

  // Ten a second for a second, whatever the server could do.
  const Json paced = Json::parse(Run(load + "--seconds 1 --rate 10 --without-sessions").out);
  EXPECT_EQ(paced["requests"], 10);
  EXPECT_EQ(paced["sessions"], 0);

  // The first query at once, the second in more years than a clock counts.
  const Json rare = Json::parse(Run(load + "--seconds 1 --rate 1e-300 --without-sessions").out);
  EXPECT_EQ(rare["requests"], 1);
}

TEST_F(MaplocTest, RobotsInTheCampusTeachTheServerAndLeaveAPicture) {
  const fs::path picture = dir_ / "campus.svg";
  const Outcome run = Run(
      "maploc simulate" + At() +
      "--map campus --seasons summer --robots 2 --queries 30 --json --picture " + picture.string());
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = Json::parse(run.out);
  ASSERT_EQ(json["sessions"].size(), 2u);
  for (const Json& session : json["sessions"]) {
    EXPECT_GE(session["localized"].get<int>(), 28);
    EXPECT_EQ(session["wrong"], 0);
  }
  int queries = 0;
  for (const Json& segment : json["segments"]) {
    queries += segment["queries"].get<int>();
    EXPECT_TRUE(segment["point_inlier_ratio"].is_number());
  }
  EXPECT_GE(queries, 60);
  EXPECT_THAT(ReadFile(picture), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace maploc
