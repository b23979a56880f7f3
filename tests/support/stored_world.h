// The drawn street (drawn_world.h) in a store.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "mapstore/store/map_store.h"
#include "tests/support/drawn_world.h"

namespace maploc::testing {

// Imports the street as a new version of its map.
inline MapKey ImportWorld(const DrawnWorld& world, MapStore* store) {
  Result<std::unique_ptr<MapWriter>> writer = store->BeginImport(world.info());
  EXPECT_TRUE(writer.ok()) << writer.status().ToString();
  for (const std::shared_ptr<const Segment>& segment : world.segments()) {
    const Status added = writer.value()->AddSegment(*segment);
    EXPECT_TRUE(added.ok()) << added.ToString();
  }
  const MapKey key = writer.value()->key();
  const Status committed = writer.value()->Commit();
  EXPECT_TRUE(committed.ok()) << committed.ToString();
  return key;
}

}  // namespace maploc::testing
