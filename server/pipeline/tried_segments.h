// The segments that a query has looked into: each is loaded and searched once.
#pragma once

#include <map>
#include <optional>

#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"
#include "server/matching/segment_matching.h"
#include "server/pipeline/attempt.h"

namespace maploc {

// Of one query, for one thread. What it returns lives as long as it does. `times` gets what a load
// (retrieval) or a search (matching) takes.
class TriedSegments {
 public:
  struct Tried {
    MapSnapshot::Entry entry;
    std::optional<SegmentSearch> search;
  };

  explicit TriedSegments(const QueryContext& context) : context_(context) {}

  // Errors: those of MapSnapshot::Load.
  Result<const MapSnapshot::Entry*> Load(int segment, StageTimes& times);
  // Loaded, and with its search. Errors as Load.
  Result<const Tried*> Search(int segment, StageTimes& times);

 private:
  Result<Tried*> Find(int segment, StageTimes& times);

  const QueryContext& context_;
  std::map<int, Tried> tried_;
};

}  // namespace maploc
