// What every store promises of maps and imports (mapstore/store/map_store.h).
#include <gmock/gmock.h>

#include "tests/contract/store/store_contract.h"

namespace maploc::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class MapContract : public StoreContract {};
INSTANTIATE_TEST_SUITE_P(Stores, MapContract,
                         ::testing::Values(StoreKind::kInMemory, StoreKind::kSqlite), NameOf);

TEST_P(MapContract, AMapComesBackAsItWentIn) {
  const MapKey key = GiveMap(*store_);
  const auto map = store_->GetMap("yard");
  ASSERT_TRUE(map.ok());
  const MapInfo& info = map->info;
  EXPECT_EQ(info.key, (MapKey{"yard", 1}));
  EXPECT_TRUE(info.metric);
  EXPECT_EQ(info.created_unix_ns, YardInfo().created_unix_ns);
  EXPECT_EQ(info.map_from_source.scale, YardInfo().map_from_source.scale);
  EXPECT_EQ(info.map_from_source.rotation.coeffs(), YardInfo().map_from_source.rotation.coeffs());
  EXPECT_EQ(info.map_from_source.translation, YardInfo().map_from_source.translation);
  EXPECT_EQ(info.point_descriptor, YardInfo().point_descriptor);
  EXPECT_EQ(info.line_descriptor, YardInfo().line_descriptor);

  const auto loaded = store_->LoadSegment(key, 1);
  ASSERT_TRUE(loaded.ok()) << loaded.status().ToString();
  const Segment& got = **loaded;
  const Segment want = YardSegment(1);
  EXPECT_EQ(got.map, key);
  EXPECT_EQ(got.id, 1);
  EXPECT_EQ(got.path_in_map, want.path_in_map);
  EXPECT_EQ(got.points.ids, want.points.ids);
  EXPECT_EQ(got.points.positions_in_map, want.points.positions_in_map);
  EXPECT_EQ(got.points.descriptors.kind, want.points.descriptors.kind);
  EXPECT_EQ(got.points.descriptors.bytes, want.points.descriptors.bytes);
  EXPECT_EQ(got.points.descriptor_landmark, want.points.descriptor_landmark);
  EXPECT_EQ(got.lines.ids, want.lines.ids);
  ASSERT_EQ(got.lines.size(), want.lines.size());
  for (int i = 0; i < got.lines.size(); ++i) {
    EXPECT_EQ(got.lines.segments_in_map[i].start, want.lines.segments_in_map[i].start);
    EXPECT_EQ(got.lines.segments_in_map[i].end, want.lines.segments_in_map[i].end);
  }
  EXPECT_EQ(got.lines.descriptors.bytes, want.lines.descriptors.bytes);
  EXPECT_EQ(got.lines.descriptor_landmark, want.lines.descriptor_landmark);
}

TEST_P(MapContract, PlacesAreWhatTheSegmentsSay) {
  const MapKey key = GiveMap(*store_);
  const auto places = store_->LoadPlaces(key);
  ASSERT_TRUE(places.ok()) << places.status().ToString();
  ASSERT_THAT(*places, SizeIs(3));
  for (const SegmentId id : {0, 1, 2}) {
    const SegmentPlace& got = (*places)[static_cast<std::size_t>(id)];
    const SegmentPlace want = PlaceOf(YardSegment(id));
    EXPECT_EQ(got.id, id);
    EXPECT_EQ(got.path_in_map, want.path_in_map);
    EXPECT_EQ(got.reach, want.reach);
    EXPECT_EQ(got.ids, want.ids);
    EXPECT_EQ(got.row_counts, want.row_counts);
    EXPECT_EQ(got.descriptors.kind, want.descriptors.kind);
    EXPECT_EQ(got.descriptors.bytes, want.descriptors.bytes);
    EXPECT_EQ(got.descriptor_landmark, want.descriptor_landmark);
  }
  EXPECT_EQ(store_->LoadPlaces({"yard", 2}).status().code(), StatusCode::kNotFound);
}

TEST_P(MapContract, FromWhereLandmarksWereSeenComesBackWhereItIsKnown) {
  auto writer = store_->BeginImport(YardInfo()).value();
  ASSERT_TRUE(writer->AddSegment(YardSegment(0)).ok());
  ASSERT_TRUE(writer->AddSegment(SeenYardSegment(1)).ok());
  Segment wrong = SeenYardSegment(2);
  wrong.points.viewing.pop_back();
  EXPECT_EQ(writer->AddSegment(wrong).code(), StatusCode::kInvalidArgument);
  ASSERT_TRUE(writer->Commit().ok());

  const auto unknown = store_->LoadSegment(writer->key(), 0).value();
  EXPECT_THAT(unknown->points.viewing, IsEmpty());
  EXPECT_THAT(unknown->lines.viewing, IsEmpty());
  const auto known = store_->LoadSegment(writer->key(), 1).value();
  const Segment want = SeenYardSegment(1);
  EXPECT_EQ(known->points.viewing, want.points.viewing);
  EXPECT_EQ(known->lines.viewing, want.lines.viewing);
}

TEST_P(MapContract, ALandmarkInTwoSegmentsCountsOnceInTheMap) {
  const MapKey key = GiveMap(*store_);
  const auto map = store_->GetMap(key);
  ASSERT_TRUE(map.ok());
  EXPECT_EQ(map->segments, 3);
  EXPECT_EQ(map->points, 320);      // 3 x 120, of which 2 x 20 twice
  EXPECT_EQ(map->lines, 7);         // 3 x 2 and the shared one
  EXPECT_EQ(map->usable_lines, 4);  // 3 and the shared one
  const SegmentSummary segment = At(key, 2);
  EXPECT_EQ(segment.points, 120);
  EXPECT_EQ(segment.lines, 3);
  EXPECT_EQ(segment.usable_lines, 2);
  EXPECT_EQ(segment.path_in_map, YardSegment(2).path_in_map);
}

TEST_P(MapContract, AnImportIsInvisibleUntilItsCommit) {
  const std::int64_t before = Changes();
  auto writer = store_->BeginImport(YardInfo());
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(0)).ok());
  EXPECT_THAT(store_->ListMaps().value(), IsEmpty());
  EXPECT_EQ(store_->GetMap("yard").status().code(), StatusCode::kNotFound);
  EXPECT_EQ(store_->ListSegments((*writer)->key()).status().code(), StatusCode::kNotFound);
  EXPECT_EQ(store_->LoadSegment((*writer)->key(), 0).status().code(), StatusCode::kNotFound);
  EXPECT_EQ(store_->StartSession(OpenSession("s", (*writer)->key())).code(), StatusCode::kNotFound);
  EXPECT_EQ(Changes(), before);
  ASSERT_TRUE((*writer)->Commit().ok());
  EXPECT_THAT(store_->ListMaps().value(), SizeIs(1));
  EXPECT_GT(Changes(), before);
  EXPECT_TRUE(store_->Verify().ok());
}

TEST_P(MapContract, AnImportThatIsDroppedLeavesNothing) {
  {
    auto writer = store_->BeginImport(YardInfo());
    ASSERT_TRUE((*writer)->AddSegment(YardSegment(0)).ok());
    ASSERT_TRUE((*writer)->AddSegment(YardSegment(1)).ok());
  }
  EXPECT_THAT(store_->ListMaps().value(), IsEmpty());
  EXPECT_EQ(GiveMap(*store_).version, 1);
}

TEST_P(MapContract, ASweepSparesALivingImport) {
  auto writer = store_->BeginImport(YardInfo());
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(0)).ok());
  ASSERT_TRUE(store_->SweepAbandonedImports().ok());
  auto other = store_->BeginImport(YardInfo("other"));
  ASSERT_TRUE(other.ok());
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(1)).ok());
  ASSERT_TRUE((*writer)->Commit().ok());
  EXPECT_EQ(store_->GetMap("yard")->segments, 2);
}

TEST_P(MapContract, TwoImportsOfOneNameBecomeTwoVersions) {
  auto first = store_->BeginImport(YardInfo());
  auto second = store_->BeginImport(YardInfo());
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_NE((*first)->key().version, (*second)->key().version);
  ASSERT_TRUE((*first)->AddSegment(YardSegment(0)).ok());
  ASSERT_TRUE((*second)->AddSegment(YardSegment(0)).ok());
  ASSERT_TRUE((*second)->Commit().ok());
  ASSERT_TRUE((*first)->Commit().ok());
  EXPECT_EQ(store_->GetMap("yard")->info.key.version, 2);
  EXPECT_TRUE(store_->GetMap(MapKey{"yard", 1}).ok());
}

TEST_P(MapContract, OldVersionsStayAndTheNewestIsListed) {
  const MapKey old = GiveMap(*store_, "yard", 3);
  GiveMap(*store_, "alley", 1);
  Start("s", old);
  const MapKey fresh = GiveMap(*store_, "yard", 2);
  EXPECT_EQ(fresh.version, 2);
  const auto maps = store_->ListMaps().value();
  ASSERT_THAT(maps, SizeIs(2));
  EXPECT_EQ(maps[0].info.key, (MapKey{"alley", 1}));
  EXPECT_EQ(maps[1].info.key, fresh);
  End("s", {Seen(1, 2)});
  EXPECT_EQ(At(old, 2).statistics.queries, 1);
  EXPECT_EQ(At(fresh, 1).statistics.queries, 0);
}

TEST_P(MapContract, ARefusedSegmentLeavesTheImportAsItWas) {
  auto writer = store_->BeginImport(YardInfo());
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(0)).ok());
  Segment nan = YardSegment(1);
  nan.points.positions_in_map[3].y() = std::numeric_limits<double>::quiet_NaN();
  const Status refused = (*writer)->AddSegment(nan);
  EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(refused.message(), ::testing::HasSubstr("points.positions_in_map[3]"));
  EXPECT_EQ((*writer)->AddSegment(YardSegment(2)).code(), StatusCode::kInvalidArgument);  // a gap
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(1)).ok());
  ASSERT_TRUE((*writer)->Commit().ok());
  EXPECT_EQ((*writer)->Commit().code(), StatusCode::kFailedPrecondition);
  EXPECT_EQ((*writer)->AddSegment(YardSegment(2)).code(), StatusCode::kFailedPrecondition);
  EXPECT_EQ(store_->GetMap("yard")->segments, 2);
}

TEST_P(MapContract, AMapWithoutSegmentsOrWithABadNameIsRefused) {
  auto writer = store_->BeginImport(YardInfo());
  EXPECT_EQ((*writer)->Commit().reason(), "EMPTY_MAP");
  EXPECT_EQ(store_->BeginImport(YardInfo("")).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(store_->BeginImport(YardInfo("a\nb")).status().code(), StatusCode::kInvalidArgument);
  MapInfo flat = YardInfo();
  flat.map_from_source.scale = 0.0;
  EXPECT_EQ(store_->BeginImport(flat).status().code(), StatusCode::kInvalidArgument);
}

TEST_P(MapContract, WhatIsUnknownIsNotFound) {
  const MapKey key = GiveMap(*store_);
  const MapKey none{"yard", 7};
  const auto not_found = StatusCode::kNotFound;
  EXPECT_EQ(store_->GetMap("nowhere").status().code(), not_found);
  EXPECT_EQ(store_->GetMap(none).status().code(), not_found);
  EXPECT_EQ(store_->ListSegments(none).status().code(), not_found);
  EXPECT_EQ(store_->GetSegment(key, 3).status().code(), not_found);
  EXPECT_EQ(store_->GetSegment(key, -1).status().code(), not_found);
  EXPECT_EQ(store_->LoadSegment(key, 3).status().code(), not_found);
  EXPECT_EQ(store_->ListRows(key, 3).status().code(), not_found);
  EXPECT_EQ(store_->ListDecisions(key, 3).status().code(), not_found);
  EXPECT_EQ(store_->PinStrategy(key, 3, Strategy::k2P).code(), not_found);
  EXPECT_EQ(store_->StartSession(OpenSession("s", none)).code(), not_found);
  EXPECT_EQ(store_->GetSession("s").status().code(), not_found);
  EXPECT_EQ(store_->ListObservations("s").status().code(), not_found);
  EXPECT_EQ(Append(*store_, "s", {}).code(), not_found);
  EXPECT_EQ(store_->EndSession("s", SessionEnd::kIdle, 1, {}).status().code(), not_found);
}

}  // namespace
}  // namespace maploc::testing
