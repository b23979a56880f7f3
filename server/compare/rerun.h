// Recorded queries, run again as the server runs them, without one.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/model/strategy.h"
#include "proto/recording/change_report.h"
#include "proto/recording/recording.h"
#include "server/pipeline/map_snapshot.h"

namespace maploc {

// What the queries are run against.
struct Side {
  std::shared_ptr<const MapSnapshot> map;
  std::optional<Strategy> strategy;  // of all samples; unset: the query's or the segment's own

  std::string Name() const;  // "version 2", "version 2 with 1p1l"
};

// On all cores, with the server's defaults. Told from time to time: how many queries are done.
// REQUIRES: positions of the recording.
Result<ChangeReport> Rerun(const Recording& recording, const std::vector<RecordPosition>& positions,
                           const Side& before, const Side& after,
                           const std::function<void(int done)>& progress);

}  // namespace maploc
