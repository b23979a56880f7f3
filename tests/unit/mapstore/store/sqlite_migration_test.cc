// Stores of older schema versions are brought up to date, with all their rows. (Version 1, whose
// decisions are derived anew: sqlite_derivation_test.)
#include <vector>

#include "tests/unit/mapstore/store/sqlite_store_fixture.h"

namespace maploc::testing {
namespace {

class SqliteMigrationTest : public SqliteStoreTest {
 protected:
  // A store of schema version 4, made by SQL from a present one that knows nothing newer.
  void MakeVersion4From(const std::string& fresh_path) {
    auto old = SqliteDatabase::Open(path_, SqliteAccess::kCreate, 1000).value();
    const auto run = [&old](const std::string& sql) {
      const Status status = old.Execute(sql);
      ASSERT_TRUE(status.ok()) << sql << ": " << status.ToString();
    };
    run("ATTACH '" + fresh_path + "' AS fresh");
    for (int version = 0; version < 4; ++version) {
      run(std::string(StoreMigrations()[static_cast<std::size_t>(version)]));
    }
    run("DELETE FROM meta");
    run("INSERT INTO map_versions SELECT "
        "id, name, version, state, metric, scale, rotation_x, rotation_y, rotation_z, "
        "rotation_w, translation_x, translation_y, translation_z, point_kind, "
        "point_kind_bytes, point_kind_metric, line_kind, line_kind_bytes, "
        "line_kind_metric, created_unix_ns, segment_count, point_count, line_count, "
        "usable_line_count "
        "FROM fresh.map_versions");
    for (const char* table : {"meta", "segments", "sessions", "session_labels", "selector_options",
                              "segment_sessions", "pins", "segment_states", "inheritance"}) {
      run("INSERT INTO " + std::string(table) + " SELECT * FROM fresh." + table);
    }
    run("INSERT INTO segment_features SELECT map, segment, type, landmark_count, "
        "descriptor_count, checksum, ids, geometry, owners, descriptors "
        "FROM fresh.segment_features");
    run("INSERT INTO observations SELECT session, sequence, segment, outcome, point_matches, "
        "point_inliers, usable_line_matches, usable_line_inliers, vertical_line_matches, "
        "vertical_line_inliers, strategy, fell_back, iterations, gravity_disagreement_rad, "
        "confidence, total_ms, time_unix_ns FROM fresh.observations");
    run("PRAGMA application_id = 1835102316; PRAGMA user_version = 4");
  }
};

TEST_F(SqliteMigrationTest, AStoreOfVersion4KeepsItsRowsAndLearnsWhatIsNew) {
  const std::string fresh_path = folder_.File("fresh.db");
  const auto fresh = OpenSqliteStore(fresh_path).value();
  const MapKey key = GiveMap(*fresh);
  for (const char* id : {"ended", "open"}) {
    ASSERT_TRUE(fresh->StartSession(OpenSession(id, key)).ok());
    ASSERT_TRUE(Append(*fresh, id, {Seen(1, 1), Missed(2, 0), OutOfMap(3)}).ok());
  }
  ASSERT_TRUE(fresh->EndSession("ended", SessionEnd::kByRobot, 5000, {}).ok());
  MakeVersion4From(fresh_path);

  const auto store = Open();
  ASSERT_TRUE(store->Verify().ok()) << store->Verify().ToString();
  const auto segment = store->LoadSegment(key, 1).value();
  EXPECT_EQ(segment->points.ids, YardSegment(1).points.ids);
  EXPECT_TRUE(segment->points.viewing.empty());
  EXPECT_TRUE(segment->points.position_covariances.empty());
  EXPECT_TRUE(segment->lines.viewing.empty());
  EXPECT_EQ(store->GetSegment(key, 1)->statistics, fresh->GetSegment(key, 1)->statistics);
  const auto kept = store->ListObservations("ended").value();
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_EQ(kept[0].evidence.points, Seen(1, 1).evidence.points);
  EXPECT_EQ(kept[0].time_unix_ns, Seen(1, 1).time_unix_ns);
  EXPECT_EQ(kept[0].evidence.inlier_rms_px, 0.0);
  EXPECT_FALSE(kept[0].evidence.gravity_rejected);
  EXPECT_EQ(kept[2].outcome, Outcome::kOutOfMap);

  Observation fresh_outcome = Missed(4, 1);
  fresh_outcome.outcome = Outcome::kCalibrationInconsistent;
  ASSERT_TRUE(Append(*store, "open", {fresh_outcome}).ok());
  EXPECT_EQ(store->EndSession("open", SessionEnd::kByRobot, 6000, {})->queries, 4);
  EXPECT_TRUE(store->Verify().ok()) << store->Verify().ToString();
  EXPECT_EQ(GiveMap(*store).version, 2);
}

}  // namespace
}  // namespace maploc::testing
