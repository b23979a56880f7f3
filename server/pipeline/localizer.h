// The only place that knows every stage: retrieval -> matching -> RANSAC -> refinement ->
// judgement.
#pragma once

#include <atomic>
#include <cstdint>

#include "mapstore/base/clock.h"
#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/query.h"
#include "server/pipeline/map_snapshot.h"

namespace maploc {

struct LocalizerOptions {
  int max_segments_tried = 3;              // best ranked first, then all of them together
  double max_reprojection_error_px = 4.0;  // of a VGA-sized image (mapstore/geometry/pixel_scale.h)
  double min_confidence = 0.99;
  std::uint64_t seed =
      1;  // mixed with the query's content, so that the same request gives the same answer
};

// Pure: the same query, snapshot and options give the same answer (times apart). Thread-safe.
// Errors: FAILED_PRECONDITION (DESCRIPTOR_KIND_MISMATCH), DEADLINE_EXCEEDED, CANCELLED,
// INVALID_ARGUMENT (other than one view). Without gravity, samples are three points (kP3P),
// whatever is recorded or requested. If the matches contradict the gravity that was sent, and
// determine a pose without it, that pose is the answer, with Evidence::gravity_rejected set.
Result<Localization> Localize(const Query& query, const MapSnapshot& map,
                              const LocalizerOptions& options, Deadline deadline,
                              const std::atomic<bool>* cancelled);

}  // namespace maploc
