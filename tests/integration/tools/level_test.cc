// maploc-map level, by the binary itself: a map that leans becomes a version that does not.
#include "mapstore/geometry/gravity.h"
#include "tests/integration/tools/maploc_map_fixture.h"

namespace maploc::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Level : public MaplocMap {
 protected:
  Output Run(const std::string& arguments) {
    return Map("level --store $STORE --map yard " + arguments);
  }
  std::unique_ptr<MapStore> Open() { return std::move(OpenSqliteStore(store_)).value(); }
};

TEST_F(Level, TurnsLandmarksAndPathAndKeepsWhatSessionsTaught) {
  const Eigen::Vector3d leaning = Eigen::Vector3d(0.1, -0.05, -1).normalized();
  const Output run = Run("--gravity 0.1,-0.05,-1 --json");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json told = json::parse(run.out);
  EXPECT_EQ(told.at("version"), 2);
  EXPECT_EQ(told.at("from_version"), 1);
  EXPECT_EQ(told.at("changed"), true);
  EXPECT_NEAR(told.at("turn_deg"), 6.38, 0.01);

  const auto store = Open();
  const MapSummary before = *store->GetMap(key_);
  const MapSummary after = *store->GetMap("yard");
  const Similarity3 turn = after.info.map_from_source * before.info.map_from_source.Inverse();
  EXPECT_LT((turn.rotation * leaning - kGravityInMap).norm(), 1e-9);
  EXPECT_EQ(after.points, before.points);
  EXPECT_EQ(after.lines, before.lines);
  for (SegmentId id = 0; id < 3; ++id) {
    const auto old_segment = *store->LoadSegment(key_, id);
    const auto new_segment = *store->LoadSegment(after.info.key, id);
    for (std::size_t i = 0; i < old_segment->points.positions_in_map.size(); ++i) {
      EXPECT_LT(
          (turn * old_segment->points.positions_in_map[i] - new_segment->points.positions_in_map[i])
              .norm(),
          1e-9);
    }
    EXPECT_EQ(new_segment->points.descriptors.bytes, old_segment->points.descriptors.bytes);
    EXPECT_EQ(store->GetSegment(after.info.key, id)->statistics,
              store->GetSegment(key_, id)->statistics);
  }
}

TEST_F(Level, TellsWhichVersionsItDeleted) {
  ASSERT_TRUE(Open()->EndSession("open", SessionEnd::kByRobot, 6000, {}).ok());
  ASSERT_EQ(Run("--gravity 0.1,0,-1").exit_code, 0);
  const json told = json::parse(Run("--gravity 0.1,0,-1 --keep-versions 1 --json").out);
  EXPECT_EQ(told.at("deleted_versions"), json({1}));
  const Output text = Run("--gravity 0.1,0,-1 --keep-versions 1");
  EXPECT_THAT(text.out, HasSubstr("Version 2 is deleted.")) << text.error;
}

TEST_F(Level, ALevelMapIsLeftAlone) {
  const Output run = Run("--gravity 0,0,-2");
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.out, HasSubstr("is level already; nothing was changed"));
  EXPECT_EQ(json::parse(Run("--gravity 0,0,-1 --json").out).at("changed"), false);
  EXPECT_EQ(Open()->GetMap("yard")->info.key.version, 1);
}

TEST_F(Level, WhatMakesNoSenseIsRefusedAndChangesNothing) {
  ExpectFailed(Run("--gravity 0,0,0"), "finite direction");
  ExpectFailed(RunBinary("maploc-map level --store " + store_ + " --map field --gravity 0,1,0"),
               "field");
  EXPECT_EQ(Run("").exit_code, 2);
  EXPECT_EQ(Run("--gravity 0,1").exit_code, 2);
  EXPECT_THAT(RunBinary("maploc-map level --help").out, HasSubstr("maploc-map level --store"));
  EXPECT_EQ(Open()->GetMap("yard")->info.key.version, 1);
}

}  // namespace
}  // namespace maploc::testing
