// Which version of a map robots get, and what stays of a deleted one (mapstore/store/map_store.h).
#include <gmock/gmock.h>

#include "tests/contract/store/learning_contract.h"

namespace maploc::testing {
namespace {

using ::testing::ElementsAre;

class VersionContract : public LearningContract {
 protected:
  void SetUp() override {
    LearningContract::SetUp();
    first_ = GiveMap(*store_, "yard", kSegments);
    second_ = GiveMap(*store_, "yard", kSegments);
  }
  MapKey Stage(const std::string& name) {
    auto writer = store_->BeginImport(YardInfo(name)).value();
    for (SegmentId id = 0; id < kSegments; ++id) {
      EXPECT_TRUE(writer->AddSegment(YardSegment(id)).ok());
    }
    EXPECT_TRUE(writer->Commit({.enable = false, .keep_versions = {}}).ok());
    return writer->key();
  }
  MapKey Enabled(const std::string& name = "yard") { return store_->GetMap(name)->info.key; }
  // The versions of all maps, and which of them are enabled.
  std::vector<std::pair<std::int64_t, bool>> Versions() {
    std::vector<std::pair<std::int64_t, bool>> versions;
    const std::vector<MapSummary> maps = store_->ListVersions().value();
    for (const MapSummary& map : maps) {
      versions.emplace_back(map.info.key.version, map.enabled);
    }
    return versions;
  }
  void Drive(const SessionId& id, const MapKey& map) {
    Start(id, map);
    End(id, {Seen(1, 1, 100, 60, 20, 10), Seen(2, 1, 90, 50, 20, 10)});
  }

  MapKey first_;
  MapKey second_;
};
INSTANTIATE_TEST_SUITE_P(Stores, VersionContract,
                         ::testing::Values(StoreKind::kInMemory, StoreKind::kSqlite), NameOf);

TEST_P(VersionContract, RobotsGetTheEnabledOne) {
  EXPECT_EQ(Enabled(), second_);
  const std::int64_t before = Changes();
  ASSERT_TRUE(store_->EnableVersion(first_).ok());
  EXPECT_GT(Changes(), before);
  EXPECT_EQ(Enabled(), first_);
  EXPECT_EQ(store_->ListMaps()->size(), 1u);
  EXPECT_EQ(store_->ListMaps()->front().info.key, first_);
  EXPECT_THAT(Versions(), ElementsAre(std::pair(1, true), std::pair(2, false)));
  EXPECT_TRUE(store_->GetMap(second_).ok());

  const std::int64_t after = Changes();
  ASSERT_TRUE(store_->EnableVersion(first_).ok());
  EXPECT_EQ(Changes(), after) << "it was enabled already";
  EXPECT_EQ(store_->EnableVersion({"yard", 3}).reason(), "MAP_NOT_FOUND");
  ExpectVerified();
}

TEST_P(VersionContract, AStagedOneWaits) {
  const MapKey staged = Stage("yard");
  EXPECT_EQ(staged.version, 3);
  EXPECT_EQ(Enabled(), second_);
  ASSERT_TRUE(store_->EnableVersion(staged).ok());
  EXPECT_EQ(Enabled(), staged);

  const MapKey only = Stage("garden");
  const auto garden = store_->GetMap("garden");
  EXPECT_EQ(garden.status().reason(), "MAP_NOT_FOUND");
  EXPECT_THAT(garden.status().message(), ::testing::HasSubstr("maploc-map enable"));
  EXPECT_EQ(store_->ListMaps()->size(), 1u);
  ASSERT_TRUE(store_->EnableVersion(only).ok());
  EXPECT_EQ(Enabled("garden"), only);
  EXPECT_EQ(store_->ListMaps()->size(), 2u);
}

TEST_P(VersionContract, TheOrderOfEnablingIsKept) {
  ASSERT_TRUE(store_->EnableVersion(first_).ok());
  const auto versions = store_->ListVersions().value();
  EXPECT_GT(versions[0].enabled_order, versions[1].enabled_order);
  EXPECT_GT(versions[1].enabled_order, 0);
  Stage("yard");
  EXPECT_EQ(store_->ListVersions()->back().enabled_order, 0);
}

// What sessions teach now is what a new version starts with, not what a version taught that was
// given up.
TEST_P(VersionContract, ANewOneInheritsFromTheEnabledOne) {
  ASSERT_TRUE(store_->EnableVersion(first_).ok());
  Drive("before", first_);
  Drive("given-up", second_);
  const MapKey third = GiveMap(*store_, "yard", kSegments);
  EXPECT_EQ(At(third, 1).statistics.queries, 2);
  Drive("after", first_);
  EXPECT_EQ(At(third, 1).statistics.queries, 4);
  ExpectVerified();
}

TEST_P(VersionContract, WhatADeletedOneTaughtStays) {
  Drive("a", first_);
  Drive("b", second_);
  const MapKey third = GiveMap(*store_, "yard", kSegments);
  const SegmentStatistics taught = At(third, 1).statistics;
  for (const MapKey& old : {first_, second_}) {
    ASSERT_TRUE(store_->DeleteVersion(old).ok());
    EXPECT_EQ(store_->GetMap(old).status().reason(), "MAP_NOT_FOUND");
    EXPECT_EQ(store_->LoadSegment(old, 0).status().code(), StatusCode::kNotFound);
    EXPECT_EQ(store_->EnableVersion(old).reason(), "MAP_NOT_FOUND");
    EXPECT_EQ(store_->DeleteVersion(old).reason(), "MAP_NOT_FOUND");
  }
  EXPECT_THAT(Versions(), ElementsAre(std::pair(3, true)));
  EXPECT_EQ(At(third, 1).statistics, taught);
  EXPECT_EQ(store_->ListSessions()->size(), 2u);
  EXPECT_EQ(store_->ListObservations("b")->size(), 2u);

  ASSERT_TRUE(store_->RevokeSession("a").ok());
  EXPECT_EQ(At(third, 1).statistics.queries, 2);
  ASSERT_TRUE(store_->ReinstateSession("a").ok());
  EXPECT_EQ(At(third, 1).statistics, taught);
  EXPECT_EQ(GiveMap(*store_, "yard", kSegments).version, 4) << "numbers are not given twice";
  ExpectVerified();
}

TEST_P(VersionContract, WhatIsInUseIsNotDeleted) {
  EXPECT_EQ(store_->DeleteVersion(second_).reason(), "MAP_ENABLED");
  Start("open", first_);
  const Status refused = store_->DeleteVersion(first_);
  EXPECT_EQ(refused.reason(), "MAP_IN_USE");
  EXPECT_THAT(refused.message(), ::testing::HasSubstr("1 open sessions"));
  EXPECT_TRUE(store_->LoadSegment(first_, 0).ok());
  End("open");
  EXPECT_TRUE(store_->DeleteVersion(first_).ok());
}

using Kept = std::vector<std::pair<std::int64_t, bool>>;

TEST_P(VersionContract, OlderVersionsGoWhenTheNextOneIsEnabled) {
  Drive("taught", second_);
  auto writer = store_->BeginImport(YardInfo()).value();
  ASSERT_TRUE(writer->AddSegment(YardSegment(0)).ok());
  ASSERT_TRUE(writer->AddSegment(YardSegment(1)).ok());
  ASSERT_TRUE(writer->Commit({.enable = true, .keep_versions = 1}).ok());
  EXPECT_EQ(Versions(), (Kept{{2, false}, {3, true}}));
  EXPECT_EQ(At({"yard", 3}, 1).statistics.queries, 2) << "what a kept or deleted one taught stays";

  const MapKey staged = Stage("yard");
  ASSERT_TRUE(store_->EnableVersion(staged, 0).ok());
  EXPECT_EQ(Versions(), (Kept{{4, true}}));
  EXPECT_EQ(At(staged, 1).statistics.queries, 2);
  ExpectVerified();
}

// A rollback goes to the version that was enabled last: this one is kept first.
TEST_P(VersionContract, WhatWasEnabledLastIsKeptFirst) {
  const MapKey never = Stage("yard");
  ASSERT_TRUE(store_->EnableVersion(first_).ok());
  const MapKey fourth = GiveMap(*store_, "yard", kSegments);
  ASSERT_TRUE(store_->EnableVersion(fourth, 2).ok());
  EXPECT_EQ(Versions(), (Kept{{1, false}, {2, false}, {4, true}})) << "of " << never.version;
  ASSERT_TRUE(store_->EnableVersion(fourth, 1).ok());
  EXPECT_EQ(Versions(), (Kept{{1, false}, {4, true}}));
}

TEST_P(VersionContract, NeitherNewerOnesNorThoseInUseNorOtherMapsGo) {
  const MapKey garden = GiveMap(*store_, "garden", kSegments);
  ASSERT_TRUE(store_->EnableVersion(garden).ok());
  Start("open", first_);
  const MapKey staged = Stage("yard");
  ASSERT_TRUE(store_->EnableVersion(second_, 0).ok());
  EXPECT_EQ(Versions(), (Kept{{1, true}, {1, false}, {2, true}, {staged.version, false}}));
  End("open");
  ASSERT_TRUE(store_->EnableVersion(second_, 0).ok());
  EXPECT_EQ(Versions(), (Kept{{1, true}, {2, true}, {staged.version, false}}));
}

}  // namespace
}  // namespace maploc::testing
