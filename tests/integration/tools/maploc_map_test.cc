// Runs the binary itself: exit codes, JSON keys and where its words go (interface.md).
#include "tests/integration/tools/maploc_map_fixture.h"

namespace maploc::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST_F(MaplocMap, EveryCommandHelpsWithAnExample) {
  for (const std::string command : {"list", "versions", "enable", "rollback", "delete", "segments",
                                    "stats", "strategy", "explain", "sessions", "revoke", "robots",
                                    "verify", "level", "backup", "restore", "plot"}) {
    const Output run = Map(command + " --help");
    EXPECT_EQ(run.exit_code, 0) << command << ": " << run.error;
    EXPECT_THAT(run.out, HasSubstr("maploc-map " + command + " --store")) << command;
    EXPECT_EQ(run.error, "");
  }
  EXPECT_EQ(Map("--help").exit_code, 0);
}

TEST_F(MaplocMap, WrongUsageIsTwo) {
  for (const char* wrong :
       {"", "frobnicate", "list", "list --store $STORE --frob", "segments --store $STORE",
        "strategy --store $STORE --map yard", "strategy --store $STORE --map yard --segment two",
        "strategy --store $STORE --map yard --segment 1 --pin p3p",
        "strategy --store $STORE --map yard --segment 1 --pin 2p --unpin", "backup --store $STORE",
        "revoke --store $STORE", "list --store"}) {
    const Output run = Map(wrong);
    EXPECT_EQ(run.exit_code, 2) << wrong;
    EXPECT_EQ(run.out, "") << wrong;
    EXPECT_NE(run.error, "") << wrong;
  }
}

TEST_F(MaplocMap, ChoicesAreToldByTheirNames) {
  const std::string pin = "strategy --store $STORE --map yard --segment 1 --pin p3p";
  EXPECT_THAT(Map(pin).error, HasSubstr("p3p not in {1p1l,2p,mixed}"));
  EXPECT_THAT(Map("plot --help").out, HasSubstr("{strategy,inlier-ratio,change}"));
}

TEST_F(MaplocMap, AFailureIsOneWithItsCause) {
  const std::string none = folder_.File("none.db");
  ExpectFails("list --store " + none, "none.db: there is no such store");
  EXPECT_FALSE(std::filesystem::exists(none));
  const std::string text = folder_.File("notes.txt");
  WriteFile(text, "not a database");
  ExpectFails("verify --store " + text, "notes.txt: is not a maploc store");
  ExpectFails("segments --store $STORE --map nowhere", "map 'nowhere' does not exist");
  for (const std::string command : {"stats", "robots"}) {
    ExpectFails(command + " --store $STORE --map yard --version 0", "version: must be 1 or more");
  }
  ExpectFails("strategy --store $STORE --map yard --segment 9", "segment 9 of map 'yard'");
  ExpectFails("backup --store $STORE --to " + text, "exists already");
  for (const std::string command : {"backup --store $STORE", "export --store $STORE --map yard"}) {
    ExpectFails(command + " --to " + folder_.File("no/new.db"), "no/new.db: cannot be written");
  }
  for (const std::string command : {"restore", "import"}) {
    ExpectFails(command + " --store $STORE --from " + none,
                "none.db: there is no such file; check --from");
  }
  ExpectFails("plot --store $STORE --map yard --out " + folder_.File("no/plan.svg"), "plan.svg");
  ExpectFails("plot --store $STORE --map yard --out " + folder_.File("plan.png"),
              "must end in .svg");
}

TEST_F(MaplocMap, ListSaysWhatThereIs) {
  const json maps = Json("list --store $STORE");
  ASSERT_EQ(maps.size(), 1u);
  const json want = {{"map", "yard"}, {"version", 1}, {"metric", true},   {"segments", 3},
                     {"points", 320}, {"lines", 7},   {"usable_lines", 4}};
  for (const auto& [key, value] : want.items()) EXPECT_EQ(maps[0].at(key), value) << key;
}

TEST_F(MaplocMap, SegmentsTellWhatSessionsTaught) {
  const json segments = Json("segments --store $STORE --map yard");
  ASSERT_EQ(segments.size(), 3u);
  const json untouched = {{"segment", 0},
                          {"points", 120},
                          {"lines", 3},
                          {"usable_lines", 2},
                          {"strategy", "mixed"},
                          {"strategy_source", "default"},
                          {"sessions", 0},
                          {"queries", 0},
                          {"localized", 0},
                          {"point_inlier_ratio", nullptr},
                          {"line_inlier_ratio", nullptr}};
  for (const auto& [key, value] : untouched.items()) EXPECT_EQ(segments[0].at(key), value) << key;
  const json& visited = segments[1];
  EXPECT_EQ(visited.at("strategy"), "1p1l");
  EXPECT_EQ(visited.at("strategy_source"), "learned");
  EXPECT_EQ(visited.at("sessions"), 1);
  EXPECT_EQ(visited.at("queries"), 21);
  EXPECT_EQ(visited.at("localized"), 20);
  EXPECT_DOUBLE_EQ(visited.at("point_inlier_ratio"), 0.2);
  EXPECT_DOUBLE_EQ(visited.at("line_inlier_ratio"), 18.0 / 25.0);
}

TEST_F(MaplocMap, StatsAreEqualWhenRecomputed) {
  const json stats = Json("stats --store $STORE --map yard --recompute");
  ASSERT_EQ(stats.size(), 3u);
  EXPECT_EQ(stats[1].at("point_matches"), 2000.0);
  EXPECT_EQ(stats[1].at("typical_point_matches"), 100.0);
  EXPECT_EQ(stats[1].at("recomputed_equal"), true);
  const std::string text = Map("stats --store $STORE --map yard --recompute").out;
  EXPECT_THAT(text, HasSubstr("equal"));
  EXPECT_THAT(text, HasSubstr("p, l, lv: "));
}

TEST_F(MaplocMap, AStrategyCanBePinnedAndGivenBack) {
  const std::string segment = "strategy --store $STORE --map yard --segment 1";
  EXPECT_EQ(Json(segment).at("strategy"), "1p1l");
  const json pinned = Json(segment + " --pin 2p");
  EXPECT_EQ(pinned.at("strategy"), "2p");
  EXPECT_EQ(pinned.at("strategy_source"), "pinned");
  EXPECT_EQ(Json("segments --store $STORE --map yard")[1].at("strategy_source"), "pinned");
  const json unpinned = Json(segment + " --unpin");
  EXPECT_EQ(unpinned.at("strategy"), "1p1l");
  EXPECT_EQ(unpinned.at("strategy_source"), "learned");
  const json why = Json("explain --store $STORE --map yard --segment 1");
  EXPECT_EQ(why.at("decisions").size(), 3u);
  EXPECT_GT(why.at("draws").at("1p1l").at("success_probability"),
            why.at("draws").at("2p").at("success_probability"));
}

// 20 localized queries of 100 points (20 right) and 20 usable lines (16 right): worth 200 matches
// of each, and a prior of 10 at 0.3.
TEST_F(MaplocMap, ExplainLaysTheArithmeticOpen) {
  const json why = Json("explain --store $STORE --map yard --segment 1");
  EXPECT_EQ(why.at("strategy"), "1p1l");
  EXPECT_EQ(why.at("ranking"), json({"1p1l", "mixed", "2p"}));
  const json& points = why.at("rates").at("points");
  EXPECT_DOUBLE_EQ(points.at("independent"), 200.0);
  EXPECT_DOUBLE_EQ(why.at("lambda"), (200 * 0.2 + 3) / 210);
  EXPECT_DOUBLE_EQ(why.at("gamma"), (200 * 0.8 + 3) / 210);
  EXPECT_LT(points.at("credible_95").at(0), why.at("lambda"));
  EXPECT_GT(points.at("credible_95").at(1), why.at("lambda"));
  for (const auto& [strategy, draw] : why.at("draws").items()) {
    const double spent =
        draw.at("cost_of_iteration").get<double>() * draw.at("expected_iterations").get<double>();
    EXPECT_NEAR(draw.at("expected_time_to_success"),
                spent / draw.at("query_probability").get<double>(), 1e-9)
        << strategy;
  }
  EXPECT_EQ(why.at("choice").at("best"), "1p1l");
  EXPECT_EQ(why.at("choice").at("hysteresis"), 0.15);
  ASSERT_EQ(why.at("switches").size(), 1u);
  EXPECT_EQ(why.at("switches")[0].at("before"), "mixed");
  EXPECT_EQ(why.at("decisions")[0].at("time"), "1970-01-01 00:00:00Z");
  const std::string text = Map("explain --store $STORE --map yard --segment 1").out;
  EXPECT_THAT(text, HasSubstr("lambda = 0.205 (95%: "));
  EXPECT_THAT(text, HasSubstr("time (UTC)"));
  const json nothing = Json("explain --store $STORE --map yard --segment 0");
  EXPECT_EQ(nothing.at("strategy_source"), "default");
  EXPECT_EQ(nothing.at("draws").at("2p").at("expected_time_to_success"), nullptr);
}

TEST_F(MaplocMap, SessionsAreListed) {
  const json sessions = Json("sessions --store $STORE");
  ASSERT_EQ(sessions.size(), 2u);
  EXPECT_EQ(sessions[0].at("session"), "s");
  EXPECT_EQ(sessions[0].at("state"), "by_robot");
  EXPECT_EQ(sessions[0].at("queries"), 21);
  EXPECT_EQ(sessions[0].at("localized"), 20);
  EXPECT_EQ(sessions[0].at("labels").at("season"), "autumn");
  Session asked = OpenSession("asked", key_, 3000);
  asked.labels["maploc.request_id"] = "4711";
  ASSERT_TRUE(OpenSqliteStore(store_).value()->StartSession(asked).ok());
  EXPECT_EQ(Map("sessions --store $STORE").out.find("4711"), std::string::npos);
  EXPECT_EQ(Json("sessions --store $STORE")[2].at("labels").at("maploc.request_id"), "4711");
  EXPECT_EQ(sessions[0].at("segments"), json::array({{{"segment", 1}, {"queries", 21}}}));
  EXPECT_EQ(sessions[0].at("stands_out"), false);
  EXPECT_EQ(sessions[1].at("state"), "open");
}

TEST_F(MaplocMap, ARevokedSessionNoLongerCountsUntilItIsTakenBack) {
  const json before = Json("segments --store $STORE --map yard");
  const json revoked = Json("revoke --store $STORE --session s");
  EXPECT_EQ(revoked.at("session"), "s");
  EXPECT_EQ(revoked.at("revoked"), true);
  EXPECT_EQ(revoked.at("changed"), true);
  EXPECT_EQ(
      revoked.at("segments"),
      json::array({{{"segment", 1}, {"strategy_before", "1p1l"}, {"strategy_after", "mixed"}}}));
  EXPECT_EQ(Json("sessions --store $STORE")[0].at("revoked"), true);
  const json without = Json("segments --store $STORE --map yard");
  EXPECT_EQ(without[1].at("queries"), 0);
  EXPECT_EQ(without[1].at("strategy_source"), "default");
  EXPECT_EQ(Json("verify --store $STORE").at("ok"), true);
  EXPECT_EQ(Json("stats --store $STORE --map yard --recompute")[1].at("recomputed_equal"), true);
  EXPECT_EQ(Json("revoke --store $STORE --session s").at("changed"), false);
  EXPECT_THAT(Map("revoke --store $STORE --session open").out, HasSubstr("still open"));
  EXPECT_EQ(Json("revoke --store $STORE --session s --undo").at("revoked"), false);
  EXPECT_EQ(Json("segments --store $STORE --map yard"), before);
  ExpectFails("revoke --store $STORE --session nobody", "session 'nobody' does not exist");
}

// Twelve days and nights; from the sixth day on the points of segment 2 are gone by day.
class MaplocMapSeason : public MaplocMap {
 protected:
  void SetUp() override {
    MaplocMap::SetUp();
    const auto store = OpenSqliteStore(store_).value();
    ASSERT_TRUE(store->RevokeSession("s").ok());
    for (int day = 1; day <= 12; ++day) {
      for (const std::string light : {"day", "night"}) {
        const std::string id = light + std::to_string(day);
        Session session = OpenSession(id, key_, day * std::int64_t{86'400'000'000'000});
        session.labels = {{"light", light}, {"season", "autumn"}};
        ASSERT_TRUE(store->StartSession(session).ok());
        std::vector<Observation> seen;
        for (int i = 1; i <= 15; ++i) {
          seen.push_back(Seen(2 * i - 1, 1, 100, 60));
          seen.push_back(Seen(2 * i, 2, 100, light == "day" && day >= 6 ? 5 : 60));
        }
        ASSERT_TRUE(store->EndSession(id, SessionEnd::kByRobot, session.start_unix_ns, seen).ok());
      }
    }
  }
};

TEST_F(MaplocMapSeason, StatsTellWhereTheMapIsDyingSinceWhenAndInWhat) {
  const std::string by_day = "stats --store $STORE --map yard --label light=day";
  const json stats = Json(by_day);
  EXPECT_EQ(stats[1].at("sessions"), 12);
  EXPECT_EQ(stats[1].at("changes"), json::array());
  EXPECT_EQ(stats[1].at("decline_rank"), nullptr);
  EXPECT_EQ(stats[2].at("decline_rank"), 1);
  ASSERT_EQ(stats[2].at("changes").size(), 1u);
  const json& change = stats[2].at("changes")[0];
  EXPECT_EQ(change.at("kind"), "points");
  EXPECT_EQ(change.at("since_session"), "day6");
  EXPECT_EQ(change.at("since_unix_ns"), 6 * std::int64_t{86'400'000'000'000});
  EXPECT_DOUBLE_EQ(change.at("before"), 0.6);
  EXPECT_DOUBLE_EQ(change.at("after"), 0.05);
  const std::string text = Map(by_day).out;
  EXPECT_THAT(text, HasSubstr("Segments that got worse, worst first:"));
  EXPECT_THAT(text, HasSubstr("1970-01-07"));
  EXPECT_THAT(Map("stats --store $STORE --map yard --label light=night").out,
              HasSubstr("No segment has become worse"));
}

TEST_F(MaplocMapSeason, StatsByALabelAndOfAVersion) {
  const json groups = Json("stats --store $STORE --map yard --by light --label season=autumn");
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].at("by"), "light");
  EXPECT_EQ(groups[0].at("value"), "day");
  EXPECT_EQ(groups[1].at("value"), "night");
  EXPECT_LT(groups[0].at("segments")[2].at("point_inlier_ratio"), 0.1);
  EXPECT_DOUBLE_EQ(groups[1].at("segments")[2].at("point_inlier_ratio"), 0.6);
  EXPECT_EQ(Json("stats --store $STORE --map yard --label light=fog")[1].at("sessions"), 0);
  EXPECT_EQ(Map("stats --store $STORE --map yard --label light").exit_code, 2);
  GiveMap(*OpenSqliteStore(store_).value());
  const json fresh = Json("stats --store $STORE --map yard --recompute");
  EXPECT_EQ(fresh[1].at("inherited_sessions"), 24);
  EXPECT_EQ(fresh[1].at("recomputed_equal"), true);
  const json old = Json("stats --store $STORE --map yard --version 1");
  EXPECT_EQ(old[1].at("inherited_sessions"), 0);
  EXPECT_EQ(old[1].at("queries"), 24 * 15);
}

TEST_F(MaplocMapSeason, PlotsTellStrategyRatioAndChange) {
  for (const std::string colour : {"strategy", "inlier-ratio", "change"}) {
    const std::string out = folder_.File(colour + ".svg");
    EXPECT_EQ(Json("plot --store $STORE --map yard --colour " + colour + " --out " + out).at("out"),
              out);
    EXPECT_THAT(ReadFile(out), HasSubstr("segments by"));
  }
  EXPECT_EQ(Map("plot --store $STORE --map yard --out x.svg --colour mood").exit_code, 2);
}

TEST_F(MaplocMap, ABackupIsAStore) {
  const std::string copy = folder_.File("copy.db");
  EXPECT_EQ(Json("backup --store $STORE --to " + copy).at("backup"), copy);
  EXPECT_EQ(Json("verify --store " + copy).at("ok"), true);
  EXPECT_EQ(Json("segments --map yard --store " + copy),
            Json("segments --map yard --store $STORE"));
}

TEST_F(MaplocMap, ARestoreSaysWhatIsThereNow) {
  const std::string copy = folder_.File("copy.db");
  const json sessions = Json("sessions --store $STORE");
  ASSERT_EQ(Map("backup --store $STORE --to " + copy).exit_code, 0);
  const json restored = Json("restore --store $STORE --from " + copy);
  EXPECT_EQ(restored.at("maps"), 1);
  EXPECT_EQ(restored.at("versions"), 1);
  EXPECT_EQ(restored.at("sessions"), sessions.size());
  EXPECT_EQ(Json("sessions --store $STORE"), sessions);
  EXPECT_EQ(Json("verify --store $STORE").at("ok"), true);
  ExpectFails("restore --store $STORE --from " + folder_.File("none.db"),
              "no such file; check --from");
}

TEST_F(MaplocMap, APlotIsAPicture) {
  const std::string out = folder_.File("plan.svg");
  EXPECT_EQ(Json("plot --store $STORE --map yard --out " + out).at("out"), out);
  const std::string svg = ReadFile(out);
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
}

TEST_F(MaplocMap, TablesAreForPeople) {
  for (const std::string command :
       {"list", "segments --map yard", "stats --map yard", "sessions", "verify",
        "explain --map yard --segment 1", "strategy --map yard --segment 1"}) {
    const Output run = Map(command + " --store $STORE");
    EXPECT_EQ(run.exit_code, 0) << command << ": " << run.error;
    EXPECT_NE(run.out, "") << command;
    EXPECT_TRUE(json::parse(run.out, nullptr, false).is_discarded()) << command;
    EXPECT_EQ(run.error, "");
  }
}

}  // namespace
}  // namespace maploc::testing
