// From observations to rows, from rows to statistics, from statistics to a strategy: pure functions
// (design.md section 6).
#pragma once

#include <span>
#include <vector>

#include "mapstore/model/session.h"

namespace maploc {

struct StatisticsOptions {
  double half_life_sessions = 20.0;  // a session this much older counts half; positive
};

// One session's observations, by segment, ascending. Order of the observations does not matter.
// OUT_OF_MAP ones (segment -1) make no row.
std::vector<SegmentSessionRow> FoldObservations(const Session& session,
                                                std::span<const Observation> observations);

// REQUIRES: rows in the order (session_start_unix_ns, session). The age of a row is its rank from
// the end.
SegmentStatistics Aggregate(std::span<const SegmentSessionRow> rows,
                            const StatisticsOptions& options = {});

}  // namespace maploc
