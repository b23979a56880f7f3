// The four real sets of shared/data as a map in memory and honest queries.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/pipeline/map_snapshot.h"
#include "tests/experiments/lies/lie.h"

namespace maploc::lies {

struct LoadedSet {
  std::string name;
  bool metric = false;
  std::shared_ptr<const MapSnapshot> map;
  std::vector<HonestQuery> queries;
};

std::vector<std::string> SetNames();

// Imports the set as maploc-map does, with lines where there are photos. Gravity: of the IMU where
// the set has it (sigma 1 degree), else the reference's with 0.5 degrees of noise.
// REQUIRES: a name of SetNames(). Errors: a file that is missing or wrong.
Result<LoadedSet> LoadSet(const std::string& name, const std::string& data_folder,
                          std::uint64_t seed);

}  // namespace maploc::lies
