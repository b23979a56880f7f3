// The real binaries, as a script uses them: exit codes, JSON and messages of `maploc`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/integration/cli/campus_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

using MaplocTest = CampusTest;

TEST_F(MaplocTest, WrongUsageIsTwoAndHelpShowsAnExample) {
  for (const std::string wrong :
       {"", "fly", "replay --server 127.0.0.1:1", "end-session --session x --bogus",
        "replay --server a:1 --map m --colmap d --strategy 3p",
        "replay --server a:1 --map m --colmap d --label season",
        "end-session --server localhost --session x",
        "end-session --server localhost:0 --session x",
        "end-session --server localhost:99999 --session x",
        "localize --server a:1 --map m --image i --camera c --gravity 0,1",
        "load --server a:1 --map m --colmap d --robots many",
        "replay --server a:1 --map m --colmap d --without-gravity --gravity-noise-deg 1",
        "simulate --write-world w --seasons summer"}) {
    const Output refused = RunBinary("maploc " + wrong);
    EXPECT_EQ(refused.exit_code, 2) << wrong << ": " << refused.error;
  }
  for (const char* binary : {"maploc", "maploc-map", "maploc-server"}) {
    EXPECT_EQ(RunBinary(std::string(binary) + " --version").out,
              std::string(binary) + " " + MAPLOC_VERSION + "\n");
  }
  for (const char* command : {"localize", "replay", "end-session", "load", "simulate"}) {
    const Output help = RunBinary(std::string("maploc ") + command + " --help");
    EXPECT_EQ(help.exit_code, 0) << command << ": " << help.error;
    EXPECT_THAT(help.out, HasSubstr(std::string("  maploc ") + command));
  }
}

// Not what is missing because of it.
TEST_F(MaplocTest, AWrongWordIsNamed) {
  for (const auto& [line, said] : std::vector<std::pair<std::string, std::string>>{
           {"maploc localize --sever x", "maploc localize: unknown --sever; see"},
           {"maploc localise --server x", "maploc: unknown localise; see"},
           {"maploc-map import-colmap --stor s", "maploc-map import-colmap: unknown --stor; see"},
           {"maploc-map remove", "maploc-map: unknown remove; see"},
           {"maploc end-session --session x --server a:99999",
            "the port of 'a:99999' must be in [1"},
           {"maploc-map verify", "maploc-map verify: --store is required; see"},
           {"maploc-server --stor s", "maploc-server: unknown --stor; see"}}) {
    const Output refused = RunBinary(line);
    EXPECT_EQ(refused.exit_code, 2) << line;
    EXPECT_THAT(refused.error, HasSubstr(said));
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
    SCOPED_TRACE(command);
    ExpectFailed(RunBinary("maploc " + command), "maploc: ");
  }
}

TEST_F(MaplocTest, AServerThatIsNotThereIsAskedAfter) {
  ExpectFailed(RunBinary("maploc end-session --server 127.0.0.1:1 --session x"),
               "is maploc-server running there?");
  ExpectFailed(RunBinary("maploc localize --server 127.0.0.1:1 --map m --image i --camera absent"),
               "camera file 'absent'");
}

TEST_F(MaplocTest, AReplayLocalizesAndReportsWhatScriptsRelyOn) {
  const Output replay = RunBinary("maploc replay" + At() + "--map campus --colmap " +
                                  Campus("model") + " --database " + Campus("database.db") +
                                  " --gravity-noise-deg 0.5 --label season=summer --json");
  ASSERT_EQ(replay.exit_code, 0) << replay.error;
  const Json json = Json::parse(replay.out);
  EXPECT_EQ(json["queries"], 180);
  EXPECT_GE(json["localized"].get<int>(), 175);
  EXPECT_EQ(json["wrong"], 0);
  EXPECT_LT(json["median_translation_error_m"].get<double>(), 0.05);
  EXPECT_EQ(json["recall"].size(), 4u);
  EXPECT_GT(json["recall"]["0.25m_2deg"].get<double>(), 0.95);
  EXPECT_GT(json["auc"].get<double>(), 0.9);
  EXPECT_GT(json["latency_ms"]["p99"].get<double>(), 0.0);
  EXPECT_EQ(json["gravity_rejected"], 0);
  EXPECT_EQ(json["calibration_inconsistent"], 0);
  ASSERT_EQ(json["per_query"].size(), 180u);
  for (const char* key :
       {"name", "outcome", "translation_error_m", "rotation_error_deg", "segment", "strategy",
        "iterations", "point_matches", "point_inliers", "line_matches", "line_inliers",
        "confidence", "position_sigma_m", "rotation_sigma_deg", "gravity_rejected", "inlier_rms_px",
        "server_ms", "latency_ms"}) {
    EXPECT_TRUE(json["per_query"][0].contains(key)) << key;
  }
  for (const Json& query : json["per_query"]) {
    for (const char* key : {"translation_error_m", "position_sigma_m", "rotation_sigma_deg"}) {
      EXPECT_EQ(query[key].is_null(), query["outcome"] != "LOCALIZED") << key;
    }
    if (query["outcome"] != "LOCALIZED") continue;
    EXPECT_GT(query["position_sigma_m"], 0.0);
    EXPECT_LT(query["translation_error_m"], 6.0 * query["position_sigma_m"].get<double>());
  }

  const std::string end =
      "maploc end-session" + At() + "--json --session " + json["session"].get<std::string>();
  const Output once = RunBinary(end);
  const Output twice = RunBinary(end);
  EXPECT_EQ(once.exit_code, 0) << once.error;
  EXPECT_EQ(once.out, twice.out);
  EXPECT_EQ(Json::parse(once.out)["queries"], 180);
}

// A grey photo shows nothing: a normal answer, whose every key is there.
TEST_F(MaplocTest, APhotoThatIsNotLocalizedTellsWhatItsMatchesLeaveOpen) {
  const std::string photo = folder_->File("grey.pgm");
  WriteFile(photo, "P5 64 48 255\n" + std::string(64 * 48, '\x80'));
  const std::string camera = folder_->File("camera.txt");
  WriteFile(camera, "1 PINHOLE 64 48 50 50 32 24\n");
  const std::string command = "maploc localize" + At() + "--map campus --image " + photo +
                              " --camera " + camera + " --gravity 0,1,0";
  const Output run = RunBinary(command + " --json");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const Json json = Json::parse(run.out);
  EXPECT_NE(json["outcome"], "LOCALIZED");
  EXPECT_EQ(json.at("map_from_body"), nullptr);
  EXPECT_EQ(json.at("inlier_rms_px"), 0.0);
  EXPECT_EQ(json.at("gravity_disagreement_rad"), nullptr);
  EXPECT_EQ(json.at("focal_length_scale"), nullptr);
  EXPECT_EQ(json.at("focal_length_scale_sigma"), nullptr);
  const std::string text = RunBinary(command).out;
  EXPECT_THAT(text, HasSubstr("inlier rms   - px"));
  EXPECT_THAT(text, HasSubstr("focal length not determined by the matches"));
}

TEST_F(MaplocTest, ManyRobotsAtOnceAreReported) {
  const std::string load = "maploc load" + At() + "--map campus --colmap " + Campus("model") +
                           " --database " + Campus("database.db") +
                           " --gravity-noise-deg 0.5 --robots 4 --session-queries 5 --json ";
  const Output run = RunBinary(load + "--seconds 1");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const Json json = Json::parse(run.out);
  int answers = 0;
  for (const auto& [outcome, count] : json["outcomes"].items()) answers += count.get<int>();
  for (const auto& [code, count] : json["errors"].items()) answers += count.get<int>();
  EXPECT_GT(json["outcomes"]["LOCALIZED"].get<int>(), 0);
  EXPECT_EQ(json["requests"], answers);
  EXPECT_EQ(json["gravity_rejected"], 0);
  EXPECT_EQ(json["calibration_inconsistent"], 0);
  EXPECT_GT(json["per_second"].get<double>(), 0.0);
  EXPECT_GE(json["sessions"].get<int>(), 4);
  for (const char* key : {"p50", "p95", "p99"}) {
    EXPECT_GT(json["latency_ms"][key].get<double>(), 0.0) << key;
  }

  // Ten a second for a second, whatever the server could do.
  const Json paced = Json::parse(RunBinary(load + "--seconds 1 --rate 10 --without-sessions").out);
  EXPECT_EQ(paced["requests"], 10);
  EXPECT_EQ(paced["sessions"], 0);

  // The first query at once, the second in more years than a clock counts.
  const Json rare =
      Json::parse(RunBinary(load + "--seconds 1 --rate 1e-300 --without-sessions").out);
  EXPECT_EQ(rare["requests"], 1);
}

TEST_F(MaplocTest, RobotsInTheCampusTeachTheServerAndLeaveAPicture) {
  const std::string picture = folder_->File("campus.svg");
  const Output run = RunBinary(
      "maploc simulate" + At() +
      "--map campus --seasons summer --robots 2 --queries 30 --json --picture " + picture);
  ASSERT_EQ(run.exit_code, 0) << run.error;
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
}  // namespace maploc::testing
