// Answers do not depend on what is in memory: a map on disk under any budget answers as one that is
// wholly in memory does.
#include <gtest/gtest.h>

#include "mapstore/store/sqlite_database.h"
#include "mapstore/store/sqlite_store.h"
#include "server/pipeline/localizer.h"
#include "server/sessions/map_cache.h"
#include "tests/support/files.h"
#include "tests/support/resident_map.h"
#include "tests/support/seed.h"
#include "tests/support/stored_world.h"

namespace maploc {
namespace {

constexpr int kSegments = 5;
constexpr double kSegmentLength = 12.0;

class SegmentsOnDemandTest : public ::testing::Test {
 protected:
  SegmentsOnDemandTest() { key_ = testing::ImportWorld(world_, store_.get()); }

  static testing::DrawnWorldOptions Street() {
    testing::DrawnWorldOptions street;
    street.segments = kSegments;
    return street;
  }
  Query QueryAt(double x, Random& random, double outlier_share = 0.3) const {
    return world_.See(testing::DrawnWorld::CameraFromMapAt(x, 0.2),
                      {.outlier_share = outlier_share}, random);
  }
  static Result<Localization> Answer(const Query& query, const MapSnapshot& map) {
    return Localize(query, map, {}, kNoDeadline, nullptr);
  }
  MapCacheOptions Budget(std::int64_t bytes) const {
    MapCacheOptions options;
    options.segment_bytes = bytes;
    return options;
  }

  const testing::TemporaryFolder folder_;
  const testing::DrawnWorld world_{testing::TestRandom(), Street()};
  const std::unique_ptr<MapStore> store_ = OpenSqliteStore(folder_.File("store")).value();
  MapKey key_;
};

void ExpectSame(const Localization& got, const Localization& want) {
  EXPECT_EQ(got.outcome, want.outcome);
  EXPECT_EQ(got.segment, want.segment);
  EXPECT_EQ(got.evidence.confidence, want.evidence.confidence);
  EXPECT_EQ(got.evidence.iterations, want.evidence.iterations);
  EXPECT_EQ(got.evidence.points, want.evidence.points);
  EXPECT_EQ(got.covariance, want.covariance);
  ASSERT_EQ(got.map_from_body.has_value(), want.map_from_body.has_value());
  if (!got.map_from_body) return;
  EXPECT_EQ(got.map_from_body->translation, want.map_from_body->translation);
  EXPECT_EQ(got.map_from_body->rotation.coeffs(), want.map_from_body->rotation.coeffs());
}

TEST_F(SegmentsOnDemandTest, ATinyBudgetAnswersAsAMapInMemoryDoes) {
  std::vector<MapSnapshot::Entry> entries;
  for (const auto& segment : world_.segments()) entries.push_back({segment, {}});
  const auto resident = testing::ResidentMap(world_.info(), entries).value();
  MapCache tiny(store_.get(), Budget(1));
  MapCache roomy(store_.get());
  Random random = testing::TestRandom(1);
  int localized = 0;
  for (int i = 0; i < 30; ++i) {
    const double x = random.Uniform(0.0, kSegments * kSegmentLength);
    // Some too hard for one segment, so that several are tried and joined.
    Query query = QueryAt(x, random, i % 3 == 0 ? 0.9 : 0.3);
    if (i % 2 == 0) query.prior = PosePrior{{x, 0.0, 1.5}, 1.0 + i};
    const Result<Localization> want = Answer(query, *resident);
    localized += want->outcome == Outcome::kLocalized ? 1 : 0;
    for (MapCache* cache : {&tiny, &roomy}) {
      const auto got = Answer(query, *cache->Enabled("street").value());
      ASSERT_TRUE(got.ok()) << got.status().ToString();
      ExpectSame(*got, *want);
    }
  }
  EXPECT_GE(localized, 15);
  EXPECT_LT(localized, 30);
}

TEST_F(SegmentsOnDemandTest, ADamagedSegmentIsAnErrorOfTheQueriesThatNeedIt) {
  {
    auto database = SqliteDatabase::Open(folder_.File("store"), SqliteAccess::kWrite, 1000);
    ASSERT_TRUE(database
                    ->Execute("UPDATE segment_features SET geometry = zeroblob(length(geometry)) "
                              "WHERE segment = 4 AND type = 1")
                    .ok());
  }
  MapCache cache(store_.get());
  Random random = testing::TestRandom(1);
  const MapCache::Snapshot map = cache.Enabled("street").value();
  Query damaged = QueryAt(4.5 * kSegmentLength, random);
  damaged.prior = PosePrior{{5.5 * kSegmentLength, 0.0, 1.5}, 0.1};
  const Status status = Answer(damaged, *map).status();
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_NE(status.message().find("segment 4: points: the checksum"), std::string::npos)
      << status.ToString();
  EXPECT_EQ(Answer(QueryAt(0.5 * kSegmentLength, random), *map)->outcome, Outcome::kLocalized);
}

}  // namespace
}  // namespace maploc
