// A street that costs little to localize in, so that the load is one of sessions rather than of
// matching.
#pragma once

#include <vector>

#include "mapstore/base/random.h"
#include "tests/support/drawn_world.h"

namespace maploc::testing {

inline DrawnWorldOptions SmallStreet() {
  DrawnWorldOptions options;
  options.points_a_metre = 4;
  options.lines_a_metre = 1;
  return options;
}

inline std::vector<Query> DrawQueries(const DrawnWorld& world, Random random) {
  QueryNoise noise;
  noise.outlier_share = 0.1;
  noise.max_lines = 8;
  std::vector<Query> queries;
  for (int i = 0; i < 32; ++i) {
    noise.max_points = i % 8 == 7 ? 1 : 40;  // some that cannot be localized
    const Rigid3 camera_from_map =
        DrawnWorld::CameraFromMapAt(random.Uniform(1.0, 20.0), random.Uniform(-0.3, 0.3));
    queries.push_back(world.See(camera_from_map, noise, random));
  }
  return queries;
}

}  // namespace maploc::testing
