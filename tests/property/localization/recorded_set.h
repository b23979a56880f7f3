// The real data sets without server, store or importer: a COLMAP model and its database become a
// snapshot in memory, and recorded sessions become queries with their reference poses.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/base/status.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/query.h"
#include "server/pipeline/map_snapshot.h"

namespace maploc::testing {

struct RecordedQuery {
  std::string name;
  Query query;
  Rigid3 camera_from_map;  // the reference
};

struct GravitySource {
  std::string csv;             // of real measurements; empty: the reference's, with noise
  double noise_sigma_rad = 0;  // drawn, without a csv
  double sent_sigma_rad = 0;
};

struct RecordedSet {
  std::shared_ptr<const MapSnapshot> map;
  std::vector<RecordedQuery> queries;
};

struct SetDescription {
  std::string folder;  // holds database.db, map/ and the sessions
  std::vector<std::string> sessions;
  Eigen::Vector3d gravity_in_source;
  double segment_length_m = 10.0;  // of path; neighbours share half of it
  GravitySource gravity;
};

Result<RecordedSet> LoadRecordedSet(const SetDescription& description, Random& random);

}  // namespace maploc::testing
