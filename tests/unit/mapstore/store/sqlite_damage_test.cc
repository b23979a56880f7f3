// What was changed behind a store's back is found, named and not served.
#include <utility>

#include <gmock/gmock.h>

#include "mapstore/store/codec.h"
#include "tests/unit/mapstore/store/sqlite_store_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

class SqliteDamageTest : public SqliteStoreTest {};

TEST_F(SqliteDamageTest, ADamagedBlobIsNamedAndNotServed) {
  const MapKey key = GiveMap(*Open());
  Execute(
      "UPDATE segment_features SET geometry = substr(geometry, 1, length(geometry) - 8) "
      "WHERE segment = 1 AND type = 1");
  const auto store = Open();
  const Status status = store->LoadSegment(key, 1).status();
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_THAT(status.message(), HasSubstr("segment 1: points.positions"));
  EXPECT_TRUE(store->LoadSegment(key, 0).ok());
  ExpectVerifyNames("segment 1: points.positions");
}

// The checksum fits, but no such direction can be.
TEST_F(SqliteDamageTest, AViewThatCannotBeIsNamedAndNotServed) {
  const MapKey key = GiveMap(*Open());
  PointLandmarks points = SeenYardSegment(1).points;
  points.viewing[7].max_angle_rad = 4.0f;
  const FeatureBlobs blobs = EncodePoints(points);
  {
    auto database = SqliteDatabase::Open(path_, SqliteAccess::kWrite, 1000);
    SqliteStatement harm(*database,
                         "UPDATE segment_features SET viewing = ?1, checksum = ?2 "
                         "WHERE segment = 1 AND type = 1");
    ASSERT_TRUE(harm.Bind(blobs.viewing, static_cast<std::int64_t>(blobs.checksum)).Run().ok());
  }
  const Status status = Open()->LoadSegment(key, 1).status();
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_THAT(status.message(), HasSubstr("points.viewing[7]"));
}

TEST_F(SqliteDamageTest, AFlippedByteIsFound) {
  const MapKey key = GiveMap(*Open());
  Execute(
      "UPDATE segment_features SET descriptors = zeroblob(length(descriptors)) "
      "WHERE segment = 2 AND type = 2");
  EXPECT_EQ(Open()->LoadSegment(key, 2).status().code(), StatusCode::kDataLoss);
  ExpectVerifyNames("segment 2: lines: the checksum");
}

TEST_F(SqliteDamageTest, ACountBeyondReasonAllocatesNothing) {
  const MapKey key = GiveMap(*Open());
  Execute("UPDATE segment_features SET landmark_count = 4611686018427387904 WHERE segment = 0");
  EXPECT_EQ(Open()->LoadSegment(key, 0).status().code(), StatusCode::kDataLoss);
}

TEST_F(SqliteDamageTest, AMissingSegmentIsFound) {
  GiveMap(*Open());
  Execute(
      "DELETE FROM segment_features WHERE segment = 1; "
      "DELETE FROM segment_places WHERE segment = 1; DELETE FROM segments WHERE segment = 1");
  ExpectVerifyNames("count of segments");
}

TEST_F(SqliteDamageTest, ADamagedPlaceIsNamedAndItsLandmarksAreServed) {
  const MapKey key = GiveMap(*Open());
  Execute(
      "UPDATE segment_places SET descriptors = zeroblob(length(descriptors)) WHERE segment = 1");
  const auto store = Open();
  const Status status = store->LoadPlaces(key).status();
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_THAT(status.message(), HasSubstr("segment 1: place: the checksum"));
  EXPECT_TRUE(store->LoadSegment(key, 1).ok());
  ExpectVerifyNames("segment 1: place: the checksum");
}

TEST_F(SqliteDamageTest, APlaceThatCannotBeIsNamed) {
  const MapKey key = GiveMap(*Open());
  SegmentPlace place = PlaceOf(YardSegment(1));
  const auto keep = [&] {
    const PlaceBlobs blobs = EncodePlace(place);
    auto database = SqliteDatabase::Open(path_, SqliteAccess::kWrite, 1000);
    SqliteStatement harm(*database,
                         "UPDATE segment_places SET owners = ?1, reach = ?2, checksum = ?3 "
                         "WHERE segment = 1");
    const auto checksum = static_cast<std::int64_t>(blobs.checksum);
    ASSERT_TRUE(harm.Bind(blobs.owners, blobs.reach, checksum).Run().ok());
  };
  const double reach = std::exchange(place.reach, -1.0);
  keep();
  EXPECT_THAT(Open()->LoadPlaces(key).status().message(), HasSubstr("place.reach"));
  place.reach = reach + 1.0;  // it could be, but is not what the landmarks say
  keep();
  ExpectVerifyNames("segment 1: its place differs from its landmarks");
  place.descriptor_landmark.back() = 1'000'000;
  keep();
  EXPECT_THAT(Open()->LoadPlaces(key).status().message(), HasSubstr("place.descriptor_landmark["));
}

// It is derived data: the next session folds all rows again, and what it writes is whole.
TEST_F(SqliteDamageTest, ADamagedCheckpointIsNamedAndHealsWithTheNextSession) {
  const MapKey key = GiveMap(*Open());
  const auto end_session = [&](const std::string& id) {
    const auto store = Open();
    ASSERT_TRUE(store->StartSession(OpenSession(id, key)).ok());
    ASSERT_TRUE(store->EndSession(id, SessionEnd::kByRobot, 5000, std::vector{Seen(1, 1)}).ok());
  };
  end_session("first");
  end_session("second");
  Execute("UPDATE segment_folds SET state = zeroblob(length(state))");
  ExpectVerifyNames("segment 1: a checkpoint of its statistics is damaged");
  end_session("third");
  const auto store = Open();
  EXPECT_EQ(store->GetSegment(key, 1)->statistics.sessions, 3);
  EXPECT_TRUE(store->Verify().ok()) << store->Verify().ToString();
}

TEST_F(SqliteDamageTest, ACheckpointElsewhereIsFound) {
  const MapKey key = GiveMap(*Open());
  {
    const auto store = Open();
    ASSERT_TRUE(store->StartSession(OpenSession("s", key)).ok());
    ASSERT_TRUE(store->EndSession("s", SessionEnd::kByRobot, 5000, std::vector{Seen(1, 1)}).ok());
  }
  Execute("UPDATE segment_folds SET start_unix_ns = start_unix_ns + 1");
  ExpectVerifyNames("a checkpoint differs from its sessions' rows");
}

TEST_F(SqliteDamageTest, TamperedStatisticsAreFound) {
  {
    const auto store = Open();
    const MapKey key = GiveMap(*store);
    ASSERT_TRUE(store->StartSession(OpenSession("s", key)).ok());
    ASSERT_TRUE(store->EndSession("s", SessionEnd::kByRobot, 5, std::vector{Seen(1, 1)}).ok());
    ASSERT_TRUE(store->Verify().ok());
  }
  Execute("UPDATE segment_states SET point_inliers = point_inliers + 1");
  ExpectVerifyNames("segment 1: its statistics");
  Execute("UPDATE segment_states SET point_inliers = point_inliers - 1, strategy = 2");
  ExpectVerifyNames("segment 1: its strategy");
  Execute("UPDATE segment_states SET strategy = 3, pinned = 2");
  ExpectVerifyNames("segment 1: its pin");
  Execute("UPDATE segment_states SET pinned = NULL; UPDATE sessions SET revoked = 1");
  ExpectVerifyNames("segment 1: its statistics");
  Execute("UPDATE sessions SET revoked = 0; UPDATE segment_sessions SET queries = 7");
  ExpectVerifyNames("segment 1: its statistics");
  Execute("UPDATE segment_sessions SET queries = 1; UPDATE sessions SET queries = 2");
  ExpectVerifyNames("session 's': its summary");
}

}  // namespace
}  // namespace maploc::testing
