// A data set's folder as a set: `map/` and `database.db` become the map, every other folder with a
// COLMAP model a session, `gravity.csv` what an IMU said. Points alone.
#pragma once

#include <optional>
#include <string>

#include "tests/experiments/selection/selection_set.h"

namespace maploc::selection {

struct RecordedFolderOptions {
  std::string folder;
  // Down in the model's frame; default: the mean of gravity.csv over the map's images, and without
  // that file the importer's estimate.
  std::optional<Eigen::Vector3d> gravity_in_source;
  // Of the reference's gravity where there is no gravity.csv.
  double gravity_noise_deg = 0.5;
  std::uint64_t seed = 1;
};

// Sessions by name. Lengths are taken for metres. Errors: what is missing or wrong in which file;
// FAILED_PRECONDITION (TOO_FEW_SESSIONS) below two.
Result<SelectionSet> LoadRecordedFolder(const RecordedFolderOptions& options);

}  // namespace maploc::selection
