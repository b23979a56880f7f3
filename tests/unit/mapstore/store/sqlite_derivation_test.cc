// What a store on disk derives: with which options, after a change of the program, from older
// schema versions.
#include "tests/unit/mapstore/store/sqlite_store_fixture.h"

namespace maploc::testing {
namespace {

class SqliteDerivationTest : public SqliteStoreTest {};

// Statistics were derived with the options of their time; another configuration is no damage.
TEST_F(SqliteDerivationTest, OtherOptionsDoNotMakeOldStatisticsWrong) {
  SqliteStoreOptions options;
  options.selector.statistics.half_life_sessions = 1.0;
  options.selector.cost_1p1l = 7.0;
  options.selector.criterion = StrategyCriterion::kPaper;
  options.selector.max_iterations = 100;
  options.selector.yields.two_points = {0.5, 0.25};
  options.selector.yields.point_and_line = {0.6, 0.35};
  options.selector.yields.point_and_verticals = {0.7, 0.45};
  {
    const auto store = OpenSqliteStore(path_, options).value();
    const MapKey key = GiveMap(*store);
    for (const char* id : {"a", "b"}) {
      ASSERT_TRUE(store->StartSession(OpenSession(id, key)).ok());
      ASSERT_TRUE(store->EndSession(id, SessionEnd::kByRobot, 5, std::vector{Seen(1, 1)}).ok());
    }
  }
  const auto store = Open();
  EXPECT_TRUE(store->Verify().ok());
  EXPECT_EQ(store->GetSegment({"yard", 1}, 1)->selector, options.selector);
  EXPECT_EQ(store->GetSegment({"yard", 1}, 0)->selector, SelectorOptions{});
}

// The options in force are those of the newest session that counts, in whatever order they came.
TEST_F(SqliteDerivationTest, ARevokedSessionTakesItsOptionsAlong) {
  SqliteStoreOptions other;
  other.selector.hysteresis = 0.5;
  const MapKey key = GiveMap(*Open());
  ASSERT_TRUE(Open()->StartSession(OpenSession("old", key, 1000)).ok());
  ASSERT_TRUE(Open()->StartSession(OpenSession("new", key, 2000)).ok());
  const auto configured = OpenSqliteStore(path_, other).value();
  ASSERT_TRUE(configured->EndSession("new", SessionEnd::kByRobot, 5, std::vector{Seen(1, 1)}).ok());
  const auto store = Open();
  ASSERT_TRUE(store->EndSession("old", SessionEnd::kByRobot, 9, std::vector{Seen(1, 1)}).ok());
  EXPECT_EQ(store->GetSegment(key, 1)->selector, other.selector);
  ASSERT_TRUE(store->RevokeSession("new").ok());
  EXPECT_EQ(configured->GetSegment(key, 1)->selector, SelectorOptions{});
  EXPECT_TRUE(store->Verify().ok());
}

// A store of schema version 1, made by SQL from the maps and sessions of a present one: decisions
// stood there as they were made.
TEST_F(SqliteDerivationTest, AStoreOfVersion1IsBroughtUpToDate) {
  const std::string fresh_path = folder_.File("fresh.db");
  const auto fresh = OpenSqliteStore(fresh_path).value();
  const MapKey key = GiveMap(*fresh);
  for (const char* id : {"a", "b", "pin"}) {
    ASSERT_TRUE(fresh->StartSession(OpenSession(id, key)).ok());
    std::vector<Observation> seen;
    for (int i = 1; i <= 20; ++i) seen.push_back(Seen(i, 1, 100, 20, 20, 16));
    ASSERT_TRUE(fresh->EndSession(id, SessionEnd::kByRobot, 5000, seen).ok());
  }
  ASSERT_TRUE(fresh->PinStrategy(key, 2, Strategy::k2P).ok());
  {
    auto old = SqliteDatabase::Open(path_, SqliteAccess::kCreate, 1000).value();
    for (const std::string& sql : {"ATTACH '" + fresh_path + "' AS fresh",
                                   std::string(StoreMigrations()[0]), std::string(R"sql(
INSERT INTO map_versions SELECT id, name, version, state, metric, scale, rotation_x, rotation_y,
  rotation_z, rotation_w, translation_x, translation_y, translation_z, point_kind,
  point_kind_bytes, point_kind_metric, line_kind, line_kind_bytes, line_kind_metric,
  created_unix_ns, segment_count, point_count, line_count, usable_line_count
  FROM fresh.map_versions;
INSERT INTO segments SELECT * FROM fresh.segments;
INSERT INTO segment_features SELECT map, segment, type, landmark_count, descriptor_count, checksum,
  ids, geometry, owners, descriptors FROM fresh.segment_features;
INSERT INTO sessions SELECT * FROM fresh.sessions;
INSERT INTO session_labels SELECT * FROM fresh.session_labels;
INSERT INTO observations SELECT session, sequence, segment, outcome, point_matches, point_inliers,
  usable_line_matches, usable_line_inliers, vertical_line_matches, vertical_line_inliers, strategy,
  fell_back, iterations, gravity_disagreement_rad, confidence, total_ms, time_unix_ns
  FROM fresh.observations;
INSERT INTO segment_sessions SELECT map, segment, session, queries, localized, point_matches,
  point_inliers, usable_line_matches, usable_line_inliers, vertical_line_matches,
  vertical_line_inliers, median_point_matches, median_usable_line_matches,
  median_vertical_line_matches, strategy_before, strategy_after FROM fresh.segment_sessions;
INSERT INTO selector_options VALUES (7, 1.5, 0.05, 10, 10, 10, 0.3, 0.25, 1, 1, 1);
INSERT INTO decisions (map, segment, time_unix_ns, cause, options, pinned, strategy, source,
    reason, predicted_success, sessions, queries, localized, point_matches, point_inliers,
    usable_line_matches, usable_line_inliers, vertical_line_matches, vertical_line_inliers,
    typical_point_matches, typical_usable_line_matches, typical_vertical_line_matches)
  SELECT r.map, r.segment, 5000, r.session, 7, NULL, 3, 1, 'as it was', 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0 FROM fresh.segment_sessions r
  UNION ALL
  SELECT p.map, p.segment, p.time_unix_ns, 'pin', 7, p.strategy, 2, 3, 'as it was', 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0 FROM fresh.pins p;
PRAGMA application_id = 1835102316; PRAGMA user_version = 1;)sql")}) {
      const Status status = old.Execute(sql);
      ASSERT_TRUE(status.ok()) << status.ToString();
    }
  }
  const auto store = Open();
  ASSERT_TRUE(store->Verify().ok()) << store->Verify().ToString();
  SelectorOptions kept;
  kept.statistics.half_life_sessions = 1.5;
  kept.statistics.change_discount = 0.05;
  kept.hysteresis = 0.25;
  kept.cost_mixed = 1.0;
  kept.yields = NoGates();  // version 1 knew of none
  const SegmentSummary learned = store->GetSegment(key, 1).value();
  EXPECT_EQ(learned.selector, kept);
  EXPECT_EQ(store->ListRows(key, 1).value(), fresh->ListRows(key, 1).value());
  EXPECT_EQ(learned.statistics, Aggregate(store->ListRows(key, 1).value(), kept.statistics));
  EXPECT_EQ(learned.decision.strategy, Strategy::k1P1L);
  EXPECT_EQ(store->GetSegment(key, 2)->pinned, Strategy::k2P);
  EXPECT_EQ(store->ListDecisions(key, 1)->size(), 3u);
  const auto pinned = store->ListDecisions(key, 2).value();
  ASSERT_EQ(pinned.size(), 1u);
  EXPECT_EQ(pinned[0].cause, "pin");
  ASSERT_TRUE(store->RevokeSession("a").ok());
  EXPECT_EQ(store->GetSegment(key, 1)->statistics.sessions, 2);
  EXPECT_EQ(store->EndSession("a", SessionEnd::kByRobot, 1, {}).value(),
            fresh->EndSession("a", SessionEnd::kByRobot, 1, {}).value());
}

// As after an update of the selector: what is kept is derived anew once, and caches are told.
TEST_F(SqliteDerivationTest, WhatAnotherProgramDerivedIsDerivedAnew) {
  {
    const auto store = Open();
    const MapKey key = GiveMap(*store);
    ASSERT_TRUE(store->StartSession(OpenSession("s", key)).ok());
    ASSERT_TRUE(store->EndSession("s", SessionEnd::kByRobot, 5, std::vector{Seen(1, 1)}).ok());
  }
  const auto before = Open();
  const std::int64_t changes = before->ChangeCounter().value();
  Execute(
      "UPDATE meta SET value = value + 1 WHERE name = 'derivation_fingerprint'; "
      "UPDATE segment_states SET reason = 'an older selector said so'");
  EXPECT_FALSE(before->Verify().ok());
  const auto store = Open();
  EXPECT_TRUE(store->Verify().ok()) << store->Verify().ToString();
  EXPECT_GT(before->ChangeCounter().value(), changes);
}

}  // namespace
}  // namespace maploc::testing
