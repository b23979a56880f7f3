#include "server/pipeline/tried_segments.h"

#include <utility>

#include "server/pipeline/stopwatch.h"

namespace maploc {

Result<TriedSegments::Tried*> TriedSegments::Find(int segment, StageTimes& times) {
  if (const auto found = tried_.find(segment); found != tried_.end()) return &found->second;
  const Stopwatch watch(times.retrieval_ms);
  MAPLOC_ASSIGN_OR_RETURN(MapSnapshot::Entry entry, context_.map.Load(segment, context_.interrupt));
  // In a std::map, so that what was returned before stays in its place.
  return &tried_.emplace(segment, Tried{std::move(entry), std::nullopt}).first->second;
}

Result<const MapSnapshot::Entry*> TriedSegments::Load(int segment, StageTimes& times) {
  MAPLOC_ASSIGN_OR_RETURN(const Tried* const tried, Find(segment, times));
  return &tried->entry;
}

Result<const TriedSegments::Tried*> TriedSegments::Search(int segment, StageTimes& times) {
  MAPLOC_ASSIGN_OR_RETURN(Tried* const tried, Find(segment, times));
  if (!tried->search) {
    const Stopwatch watch(times.matching_ms);
    tried->search = SearchSegment(context_.view(), *tried->entry.segment);
  }
  return static_cast<const Tried*>(tried);
}

}  // namespace maploc
