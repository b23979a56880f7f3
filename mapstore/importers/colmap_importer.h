// A COLMAP model becomes a map: points with descriptors, lines triangulated from its photos,
// gravity on (0, 0, -1), cut into segments along the path. Everything is read, computed and checked
// before the store hears of it, so an import that fails leaves nothing behind.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/importers/parallel.h"
#include "mapstore/importers/source_gravity.h"
#include "mapstore/model/map.h"
#include "mapstore/store/map_store.h"

namespace maploc {

struct ColmapImportOptions {
  std::string map_name;
  std::string model_directory;
  std::string database_path;     // empty: none; else points take their observations' descriptors
  std::string images_directory;  // empty: none; lines, and points without a database, come from it
  std::optional<Eigen::Vector3d> gravity_in_source;  // down; none: measured or estimated
  bool force = false;                                // takes a gravity that the photos contradict
  std::optional<double> meters_per_unit;      // given: the map is metric, else its unit unknown
  std::optional<double> segment_length;       // map units; none: DefaultSegmentLength
  bool detect_lines = true;                   // "--lines auto": where there are images
  std::string line_file;                      // maploc-lines text; replaces the detection
  std::optional<DescriptorKind> descriptors;  // none: the database's, or sift_root_u8
  Publishing publishing;
  bool triangulate = false;  // points anew from the photos' features, not the model's
};

struct ColmapImportReport {
  MapInfo info;
  SourceGravity gravity;
  double segment_length = 0.0;  // map units
  std::int64_t segments = 0;
  std::int64_t frames = 0;
  std::int64_t points = 0;
  std::int64_t lines = 0;
  std::int64_t usable_lines = 0;
  std::int64_t point_descriptors = 0;
  std::int64_t line_descriptors = 0;
  std::int64_t points_without_descriptor = 0;  // of the model, left out
  // What was read of two, photos reduced, photos left out; a sentence each.
  std::vector<std::string> notices;
};

// Gives the store to write to; called once, when all else is done. The store outlives the import.
using OpenStoreFn = std::function<Result<MapStore*>()>;

// Progress may be null. An error tells of the photos that were left out, too.
Result<ColmapImportReport> ImportColmap(const ColmapImportOptions& options,
                                        const OpenStoreFn& open_store,
                                        const ProgressFn& progress = nullptr);

}  // namespace maploc
