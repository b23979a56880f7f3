// What people really have: several cameras, half a recording, a proxy, names of another encoding.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/colmap_writer.h"
#include "mapstore/store/sqlite_store.h"
#include "tests/integration/cli/campus_fixture.h"
#include "tests/support/process.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

class FaultsTest : public CampusTest {
 protected:
  static Json Sessions() {
    return Json::parse(RunBinary("maploc-map sessions --store " + Store() + " --json").out);
  }
  // A grey photo, 64 pixels wide and 48 high.
  static std::string Localize(const std::string& flags) {
    WriteFile(folder_->File("grey.pgm"), "P5 64 48 255\n" + std::string(64 * 48, '\x80'));
    return "maploc localize" + At() + "--map campus --image " + folder_->File("grey.pgm") + " " +
           flags;
  }
  static std::string OneCamera() {
    WriteFile(folder_->File("camera.txt"), "1 PINHOLE 64 48 50 50 32 24\n");
    return "--camera " + folder_->File("camera.txt") + " ";
  }
};

TEST_F(FaultsTest, OfSeveralCamerasThePhotosOwnIsTaken) {
  const std::string cameras = "--camera " + folder_->File("cameras.txt") + " ";
  WriteFile(folder_->File("cameras.txt"),
            "1 PINHOLE 48 64 50 50 24 32\n2 PINHOLE 64 48 50 50 32 24\n");
  const Output refused = RunBinary(Localize(cameras));
  ExpectFailed(refused, "2 cameras (1, 2)");
  EXPECT_THAT(refused.error, HasSubstr("--camera-id N"));
  EXPECT_EQ(RunBinary(Localize(cameras + "--camera-id 2")).exit_code, 0);
  ExpectFailed(RunBinary(Localize(cameras + "--camera-id 1")),
               "64x48 pixels as stored, but the camera");
  WriteFile(folder_->File("images.txt"), "1 1 0 0 0 0 0 0 2 grey.pgm\n\n");
  const Output found = RunBinary(Localize(cameras));
  EXPECT_EQ(found.exit_code, 0) << found.error;
}

TEST_F(FaultsTest, AReplayWithoutAllItsInputsBeginsNoSession) {
  const std::size_t before = Sessions().size();
  WriteFile(folder_->File("gravity.csv"), "map/0000,0,1,0\nmap/0001,0,9.81,0\n");
  const Output gravity = RunBinary(Replay() + "--gravity-csv " + folder_->File("gravity.csv"));
  ExpectFailed(gravity, "178 of 180 images have no gravity");
  EXPECT_THAT(gravity.error, HasSubstr("'map/0002'"));
  const Output photos = RunBinary(Replay() + "--images " + folder_->path());
  ExpectFailed(photos, "180 of 180 images have no photo");
  EXPECT_EQ(Sessions().size(), before);
}

TEST_F(FaultsTest, ACutPhotoIsNamedAndBeginsNoSession) {
  const std::size_t before = Sessions().size();
  const std::string cut("\xff\xd8\xff\xe0\0\x04zz", 8);
  WriteFile(folder_->File("cut.jpg"), cut);
  ExpectFailed(RunBinary("maploc localize" + At() + "--map campus --image " +
                         folder_->File("cut.jpg") + " " + OneCamera()),
               "cut.jpg: is truncated");
  std::filesystem::create_directories(folder_->File("photos/map"));
  for (int i = 0; i < 180; ++i) {
    const std::string number = std::to_string(10000 + i).substr(1);
    WriteFile(folder_->File("photos/map/" + number), i < 2 ? cut : cut + "\xff\xd9");
  }
  const Output replay = RunBinary(Replay() + "--images " + folder_->File("photos"));
  ExpectFailed(replay, "2 of 180 photos are truncated");
  EXPECT_THAT(replay.error, HasSubstr("'map/0000', 'map/0001'"));
  EXPECT_EQ(Sessions().size(), before);
}

TEST_F(FaultsTest, AnInterruptedReplayEndsItsSessionAndTellsItsId) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::size_t before = Sessions().size();
    Process replay({std::string(MAPLOC_BIN_DIR) + "/maploc", "replay", "--server", server_address_,
                    "--map", "campus", "--colmap", Campus("model"), "--database",
                    Campus("database.db"), "--gravity-noise-deg", "0.5"},
                   folder_->File("replay.stderr"));
    // A look by another process would take as long as many queries.
    SqliteStoreOptions look;
    look.read_only = true;
    const auto store = OpenSqliteStore(Store(), look).value();
    ASSERT_TRUE(WaitFor([&] { return store->ListSessions()->size() > before; }));
    replay.Signal(signal);
    EXPECT_EQ(replay.Wait(), 1);
    const Json session = Sessions().back();
    EXPECT_EQ(session["state"], "by_robot");
    EXPECT_LT(session["queries"], 180);
    const std::string id = session["session"];
    EXPECT_THAT(folder_->Read("replay.stderr"), HasSubstr("interrupted; session " + id));
    EXPECT_EQ(session["revoked"], true);
  }
}

// The server stands still in the middle of a session, for longer than one answer may take.
TEST_F(FaultsTest, ALateQueryIsCountedAndTheReplayGoesOn) {
  const std::size_t before = Sessions().size();
  Output run;
  std::thread replay([&] { run = RunBinary(Replay() + "--timeout 2 --json"); });
  EXPECT_TRUE(WaitFor([&] { return Sessions().size() > before; }));
  kill(server_->pid(), SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(3));
  kill(server_->pid(), SIGCONT);
  replay.join();
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["per_query"].size(), 180u);
  EXPECT_GE(json["deadline_exceeded"], 1);
  EXPECT_EQ(json["complete"], true);
  const int late = static_cast<int>(std::ranges::count_if(json["per_query"], [](const Json& query) {
    return query["outcome"] == "DEADLINE_EXCEEDED" && query["translation_error_m"].is_null();
  }));
  EXPECT_EQ(json["deadline_exceeded"], late);
  EXPECT_THAT(run.error, HasSubstr("--timeout SECONDS waits longer"));
}

TEST_F(FaultsTest, ALateAnswerNamesTheFlagThatWaitsLonger) {
  kill(server_->pid(), SIGSTOP);
  const Output late = RunBinary("maploc end-session" + At() + "--session x --timeout 0.3");
  kill(server_->pid(), SIGCONT);
  ExpectFailed(late, "no answer within 0.3 s");
  EXPECT_THAT(late.error, HasSubstr("--timeout SECONDS waits longer"));
  ExpectFailed(RunBinary("maploc end-session" + At() + "--session x --timeout 0"), "--timeout: ");
}

TEST_F(FaultsTest, AProxyDoesNotStandBetweenThisMachineAndItself) {
  setenv("http_proxy", "http://me:secret@127.0.0.1:9", 1);
  const Output own = RunBinary("maploc end-session" + At() + "--session x");
  const Output other = RunBinary("maploc end-session --server yard.invalid:1 --session x");
  unsetenv("http_proxy");
  ExpectFailed(own, "SESSION_NOT_FOUND");
  ExpectFailed(other, "the proxy http://127.0.0.1:9 of http_proxy");
  EXPECT_THAT(other.error, HasSubstr("no_proxy"));
  EXPECT_THAT(other.error, Not(HasSubstr("secret")));
}

TEST_F(FaultsTest, ANameThatCannotBeSentIsRefusedWithItsField) {
  ExpectFailed(RunBinary(Replay() + "--robot 'caf\xe9'"), "robot: is not UTF-8");
  ExpectFailed(RunBinary(Replay() + "--robot " + std::string(129, 'r')), "129 bytes long");
  ExpectFailed(RunBinary(Replay() + "--label 'season=\xe9t\xe9'"), "labels.season: ");
  ExpectFailed(RunBinary("maploc end-session" + At() + "--session 'caf\xe9'"), "session_id: ");
}

// The same words, wherever a gravity or its sigma is stated.
TEST_F(FaultsTest, GravityHasOneRule) {
  for (const char* good : {"0,1,0", "0,9.81,0.1", "0,0.99,0"}) {
    EXPECT_EQ(RunBinary(Localize(OneCamera() + "--gravity " + good)).exit_code, 0) << good;
  }
  ExpectFailed(RunBinary(Localize(OneCamera() + "--gravity 0,88,2")), "divide it by that");
  WriteFile(folder_->File("gravity.csv"), "map/0000,0,88,2\n");
  ExpectFailed(RunBinary(Replay() + "--gravity-csv " + folder_->File("gravity.csv")),
               "divide it by that");
  for (const std::string sigma : {"0", "-1", "nan", "180"}) {
    const std::string said = "--gravity-sigma-deg: must be above 0 and at most 90 degrees";
    ExpectFailed(RunBinary(Replay() + "--gravity-sigma-deg " + sigma), said);
    ExpectFailed(RunBinary(Localize(OneCamera() + "--gravity 0,1,0 --gravity-sigma-deg " + sigma)),
                 said);
  }
}

TEST_F(FaultsTest, WithoutUnitAndPointsAReplayDoesNotSayThatNoneIsWrong) {
  const Output imported =
      RunBinary("maploc-map import-colmap --store " + Store() + " --map unitless --model " +
                Campus("model") + " --database " + Campus("database.db") +
                " --descriptors orb --lines none --gravity 0,0,-1 --segment-length 45");
  ASSERT_EQ(imported.exit_code, 0) << imported.error;
  Result<ColmapModel> model = ReadColmapModel(Campus("model"));
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  model->points.clear();
  model->images.erase(std::next(model->images.begin()), model->images.end());
  for (auto& [id, image] : model->images) {
    image.keypoints_px.clear();
    image.point_ids.clear();
  }
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteColmapModel(folder.path(), *model).ok());
  const Output run = RunBinary("maploc replay" + At() + "--map unitless --colmap " + folder.path() +
                               " --database " + Campus("database.db"));
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.error, HasSubstr("wrong answers cannot be judged"));
  EXPECT_THAT(run.out, HasSubstr("1 of 1 localized, median error"));
  EXPECT_THAT(run.out, Not(HasSubstr("recall")));
}

TEST_F(FaultsTest, MorePointsThanTheServerTakesAreThinnedAndTold) {
  // Every photo's points so often that one has over 20,000.
  const Result<ColmapModel> model = ReadColmapModel(Campus("model"));
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  ColmapModel two = *model;
  std::map<std::string, PointFeatures> features;
  const auto database = ReadColmapDatabase(Campus("database.db"));
  ASSERT_TRUE(database.ok()) << database.status().ToString();
  for (const auto& [name, stored] : *database) {
    if (name != "map/0000" && name != "map/0001") continue;
    PointFeatures many = stored.points;
    while (name == "map/0001" && many.keypoints_px.size() <= 20000) {
      many.keypoints_px.insert(many.keypoints_px.end(), stored.points.keypoints_px.begin(),
                               stored.points.keypoints_px.end());
      many.descriptors.bytes.insert(many.descriptors.bytes.end(),
                                    stored.points.descriptors.bytes.begin(),
                                    stored.points.descriptors.bytes.end());
    }
    features.emplace(name, std::move(many));
  }
  std::erase_if(two.images,
                [&](const auto& image) { return !features.contains(image.second.name); });
  two.points.clear();
  for (auto& [id, image] : two.images) {
    image.keypoints_px.clear();
    image.point_ids.clear();
  }
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteColmapModel(folder.path(), two).ok());
  ASSERT_TRUE(WriteColmapDatabase(folder.File("database.db"), two, features).ok());
  const std::string replay = "maploc replay" + At() + "--map campus --json --colmap " +
                             folder.path() + " --database " + folder.File("database.db");
  const Output run = RunBinary(replay);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(Json::parse(run.out)["queries"], 2);
  EXPECT_THAT(run.error, HasSubstr("1 of 2 images have more than 20000 points"));
  EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
  EXPECT_THAT(RunBinary(replay + " --max-features 50").error,
              HasSubstr("2 of 2 images have more than 50 points"));
}

}  // namespace
}  // namespace maploc::testing
