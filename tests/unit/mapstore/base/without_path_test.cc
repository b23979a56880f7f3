#include "mapstore/base/without_path.h"

#include <gtest/gtest.h>

namespace maploc {
namespace {

TEST(WithoutPathTest, HidesWhereTheStoreLies) {
  const std::string path = "/data/map";
  EXPECT_EQ(WithoutPath("/data/map: the disk is full", path), "the disk is full");
  EXPECT_EQ(WithoutPath("/data/map: lost /data/map-wal; run `maploc-map restore --store /data/map "
                        "--from COPY` on '/data/map'.",
                        path),
            "lost STORE-wal; run `maploc-map restore --store STORE --from COPY` on 'STORE'.");
  EXPECT_EQ(WithoutPath("cannot open /data/map", path), "cannot open STORE");
  EXPECT_EQ(WithoutPath("cannot open data/map.", "data/map"), "cannot open STORE.");
  EXPECT_EQ(WithoutPath("lost /srv/data/map-wal", "data/map"), "lost STORE-wal");
  EXPECT_EQ(WithoutPath("all is well", path), "all is well");
  EXPECT_EQ(WithoutPath("", path), "");
}

TEST(WithoutPathTest, LeavesWordsThatThePathIsAPartOf) {
  EXPECT_EQ(WithoutPath("metadata/map and data/mapping", "data/map"),
            "metadata/map and data/mapping");
  EXPECT_EQ(WithoutPath("/data/maps and /data/map/yard", "/data/map"),
            "/data/maps and /data/map/yard");
}

// `maploc-server --store map`
TEST(WithoutPathTest, APathWithoutAFolderIsNoPlaceAndStays) {
  EXPECT_EQ(WithoutPath("map 'yard': not found", "map"), "map 'yard': not found");
  EXPECT_EQ(WithoutPath("map: is empty; name a map", "map"), "map: is empty; name a map");
  EXPECT_EQ(WithoutPath("anything", ""), "anything");
}

}  // namespace
}  // namespace maploc
