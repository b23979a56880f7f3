// Stores of older schema versions are brought up to date, with all their rows. (Version 1, whose
// decisions are derived anew: sqlite_derivation_test.)
#include <utility>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/store/codec.h"
#include "tests/unit/mapstore/store/sqlite_store_fixture.h"

namespace maploc::testing {
namespace {

// A table whose rows a present store gives an older one, and what that one has of its columns.
struct Given {
  std::string table;
  std::string columns = "*";
};

const std::string kRowsOfVersion6 =
    "map, segment, session, queries, localized, point_matches, point_inliers, "
    "usable_line_matches, usable_line_inliers, vertical_line_matches, vertical_line_inliers, "
    "median_point_matches, median_usable_line_matches, median_vertical_line_matches, "
    "strategy_before, strategy_after, options";

const std::string kStatesOfVersion6 =
    "map, segment, options, pinned, strategy, second_choice, third_choice, source, reason, "
    "predicted_success, sessions, queries, localized, point_matches, point_inliers, "
    "usable_line_matches, usable_line_inliers, vertical_line_matches, vertical_line_inliers, "
    "typical_point_matches, typical_usable_line_matches, typical_vertical_line_matches, "
    "weighted_queries, weighted_localized, independent_points, independent_usable_lines, "
    "independent_vertical_lines";

const std::string kMapsOfVersion4 =
    "id, name, version, state, metric, scale, rotation_x, rotation_y, rotation_z, rotation_w, "
    "translation_x, translation_y, translation_z, point_kind, point_kind_bytes, "
    "point_kind_metric, line_kind, line_kind_bytes, line_kind_metric, created_unix_ns, "
    "segment_count, point_count, line_count, usable_line_count";

const std::string kObservationsOfVersion4 =
    "session, sequence, segment, outcome, point_matches, point_inliers, usable_line_matches, "
    "usable_line_inliers, vertical_line_matches, vertical_line_inliers, strategy, fell_back, "
    "iterations, gravity_disagreement_rad, confidence, total_ms, time_unix_ns";

const std::vector<Given> kOfVersion4 = {
    {"meta"},
    {"map_versions", kMapsOfVersion4},
    {"segments"},
    {"segment_features",
     "map, segment, type, landmark_count, descriptor_count, checksum, ids, geometry, owners, "
     "descriptors"},
    {"sessions"},
    {"session_labels"},
    {"observations", kObservationsOfVersion4},
    {"selector_options"},
    {"segment_sessions", kRowsOfVersion6},
    {"pins"},
    {"segment_states", kStatesOfVersion6},
    {"inheritance"}};

const std::vector<Given> kOfVersion5 = {
    {"meta"},
    {"map_versions", kMapsOfVersion4 + ", shared_error_rad"},
    {"segments"},
    {"segment_features", "*, x''"},
    {"sessions"},
    {"session_labels"},
    {"observations", kObservationsOfVersion4 + ", inlier_rms_pixels, gravity_rejected, "
                                               "gravity_tilt_x_rad, gravity_tilt_y_rad"},
    {"selector_options"},
    {"segment_sessions", kRowsOfVersion6},
    {"pins"},
    {"segment_states", kStatesOfVersion6},
    {"inheritance"}};

class SqliteMigrationTest : public SqliteStoreTest {
 protected:
  // A present store: a map of these segments, a session that ended and an open one.
  std::unique_ptr<MapStore> MakeFresh(const std::vector<Segment>& segments) {
    auto fresh = OpenSqliteStore(fresh_path_).value();
    auto writer = fresh->BeginImport(YardInfo()).value();
    for (const Segment& segment : segments) EXPECT_TRUE(writer->AddSegment(segment).ok());
    EXPECT_TRUE(writer->Commit().ok());
    for (const char* id : {"ended", "open"}) {
      EXPECT_TRUE(fresh->StartSession(OpenSession(id, kYard)).ok());
      EXPECT_TRUE(Append(*fresh, id, {Seen(1, 1), Missed(2, 0), OutOfMap(3)}).ok());
    }
    EXPECT_TRUE(fresh->EndSession("ended", SessionEnd::kByRobot, 5000, {}).ok());
    return fresh;
  }
  // A store of an older schema version, made by SQL from the present one.
  void MakeOld(int version, const std::vector<Given>& given) {
    auto old = SqliteDatabase::Open(path_, SqliteAccess::kCreate, 1000).value();
    const auto run = [&old](const std::string& sql) {
      const Status status = old.Execute(sql);
      ASSERT_TRUE(status.ok()) << sql << ": " << status.ToString();
    };
    run("ATTACH '" + fresh_path_ + "' AS fresh");
    for (int i = 0; i < version; ++i) {
      run(std::string(StoreMigrations()[static_cast<std::size_t>(i)]));
    }
    run("DELETE FROM meta");
    for (const Given& of : given) {
      run("INSERT INTO " + of.table + " SELECT " + of.columns + " FROM fresh." + of.table);
    }
    run("PRAGMA application_id = 1835102316; PRAGMA user_version = " + std::to_string(version));
  }
  // As version 5 wrote them for points: 24 bytes a landmark, hashed last.
  void GiveCovariances() {
    auto old = SqliteDatabase::Open(path_, SqliteAccess::kWrite, 1000).value();
    std::string covariances;
    for (int i = 0; i < 24 * 120; ++i) covariances.push_back(static_cast<char>(31 * i + 7));
    SqliteStatement points(old, "SELECT segment, checksum FROM segment_features WHERE type = 1");
    const auto checksums = points.Collect([&](const SqliteStatement& row) {
      const auto without = static_cast<std::uint64_t>(row.Int("checksum"));
      return std::pair(row.Int("segment"),
                       static_cast<std::int64_t>(HashBytes(covariances, without)));
    });
    for (const auto& [segment, checksum] : checksums.value()) {
      SqliteStatement give(old,
                           "UPDATE segment_features SET covariances = ?1, checksum = ?2 "
                           "WHERE segment = ?3 AND type = 1");
      const Blob bytes(covariances.begin(), covariances.end());
      ASSERT_TRUE(give.Bind(bytes, checksum, segment).Run().ok());
    }
  }
  // Brought up to date, the store at path_ holds what the present one does.
  void ExpectSameAs(const MapStore& fresh) {
    const auto store = Open();
    ASSERT_TRUE(store->Verify().ok()) << store->Verify().ToString();
    EXPECT_EQ(Count("segment_places"), 2);
    for (const SegmentId id : {0, 1}) {
      const auto got = store->LoadSegment(kYard, id).value();
      const auto want = fresh.LoadSegment(kYard, id).value();
      EXPECT_EQ(got->path_in_map, want->path_in_map);
      EXPECT_EQ(EncodePoints(got->points).checksum, EncodePoints(want->points).checksum);
      EXPECT_EQ(got->points.viewing, want->points.viewing);
      EXPECT_EQ(EncodeLines(got->lines).checksum, EncodeLines(want->lines).checksum);
      EXPECT_EQ(got->lines.viewing, want->lines.viewing);
      EXPECT_EQ(store->GetSegment(kYard, id)->statistics, fresh.GetSegment(kYard, id)->statistics);
      EXPECT_EQ(store->ListRows(kYard, id).value(), fresh.ListRows(kYard, id).value());
    }
    const auto kept = store->ListObservations("ended").value();
    ASSERT_EQ(kept.size(), 3u);
    EXPECT_EQ(kept[0].evidence.inlier_rms_px, Seen(1, 1).evidence.inlier_rms_px);
    EXPECT_EQ(store->EndSession("open", SessionEnd::kByRobot, 6000, {})->queries, 3);
    EXPECT_EQ(Count("pragma_table_info('segment_features') WHERE name = 'covariances'"), 0);
    EXPECT_EQ(GiveMap(*store).version, 2);
    EXPECT_TRUE(store->Verify().ok()) << store->Verify().ToString();
    // It is a store that can shrink.
    EXPECT_EQ(Count("pragma_auto_vacuum WHERE auto_vacuum = 2"), 1);
    ASSERT_TRUE(store->DeleteVersion(kYard).ok());
    EXPECT_EQ(Count("pragma_freelist_count WHERE freelist_count > 0"), 0);
    EXPECT_TRUE(store->Verify().ok()) << store->Verify().ToString();
  }

  const std::string fresh_path_ = folder_.File("fresh.db");
  const MapKey kYard{"yard", 1};
};

TEST_F(SqliteMigrationTest, AStoreOfVersion4KeepsItsRowsAndLearnsWhatIsNew) {
  const auto fresh = MakeFresh({YardSegment(0), YardSegment(1)});
  MakeOld(4, kOfVersion4);

  const auto store = Open();
  ASSERT_TRUE(store->Verify().ok()) << store->Verify().ToString();
  const auto segment = store->LoadSegment(kYard, 1).value();
  EXPECT_EQ(segment->points.ids, YardSegment(1).points.ids);
  EXPECT_TRUE(segment->points.viewing.empty());
  EXPECT_TRUE(segment->lines.viewing.empty());
  EXPECT_EQ(store->GetSegment(kYard, 1)->statistics, fresh->GetSegment(kYard, 1)->statistics);
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

TEST_F(SqliteMigrationTest, AStoreOfVersion5LosesItsCovariancesAlone) {
  const auto fresh = MakeFresh({SeenYardSegment(0), YardSegment(1)});
  MakeOld(5, kOfVersion5);
  GiveCovariances();
  ExpectSameAs(*fresh);
}

TEST_F(SqliteMigrationTest, AStoreOfVersion5WithoutCovariancesKeepsAll) {
  const auto fresh = MakeFresh({SeenYardSegment(0), YardSegment(1)});
  MakeOld(5, kOfVersion5);
  ExpectSameAs(*fresh);
}

// The checksum is not made to fit what a fault left.
TEST_F(SqliteMigrationTest, WhatWasDamagedInVersion5StaysDamaged) {
  MakeFresh({SeenYardSegment(0), YardSegment(1)});
  MakeOld(5, kOfVersion5);
  GiveCovariances();
  Execute(
      "UPDATE segment_features SET geometry = zeroblob(length(geometry)) "
      "WHERE segment = 0 AND type = 1; "
      "UPDATE segment_features SET covariances = zeroblob(length(covariances)) "
      "WHERE segment = 1 AND type = 1");
  ExpectVerifyNames("segment 0: points: the checksum");
  EXPECT_EQ(Open()->LoadSegment(kYard, 1).status().code(), StatusCode::kDataLoss);
  EXPECT_EQ(Open()->LoadPlaces(kYard).status().reason(), "DAMAGED_SEGMENT");
}

// An import that ran while the store was brought up to date wrote segments as of old.
TEST_F(SqliteMigrationTest, APlaceThatIsMissingIsDerivedFromTheLandmarks) {
  const MapKey key = GiveMap(*Open());
  Execute("DELETE FROM segment_places WHERE segment = 1");
  const auto store = Open();
  const SegmentPlace place = store->LoadPlaces(key).value()[1];
  EXPECT_EQ(EncodePlace(place).checksum, EncodePlace(PlaceOf(YardSegment(1))).checksum);
  EXPECT_EQ(place.path_in_map, YardSegment(1).path_in_map);
  EXPECT_TRUE(store->Verify().ok()) << store->Verify().ToString();
}

}  // namespace
}  // namespace maploc::testing
