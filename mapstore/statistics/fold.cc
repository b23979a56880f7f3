#include <map>
#include <utility>

#include "mapstore/base/median.h"
#include "mapstore/statistics/statistics.h"

namespace maploc {
namespace {

// The matches of one segment's localized queries, one entry a query.
struct SegmentMatches {
  SegmentSessionRow row;
  std::vector<std::int32_t> points;
  std::vector<std::int32_t> usable_lines;
  std::vector<std::int32_t> vertical_lines;
};

double MedianOrZero(std::vector<std::int32_t> values) {
  return values.empty() ? 0.0 : Median(std::move(values));
}

void Count(const Observation& observation, SegmentMatches& segment) {
  SegmentSessionRow& row = segment.row;
  ++row.queries;
  // The best pose of a failed query was wrong, so its inliers say nothing about the rates.
  if (observation.outcome != Outcome::kLocalized) return;
  ++row.localized;
  const Evidence& evidence = observation.evidence;
  row.point_matches += evidence.points.matches;
  row.point_inliers += evidence.points.inliers;
  row.usable_line_matches += evidence.usable_lines.matches;
  row.usable_line_inliers += evidence.usable_lines.inliers;
  row.vertical_line_matches += evidence.vertical_lines.matches;
  row.vertical_line_inliers += evidence.vertical_lines.inliers;
  segment.points.push_back(evidence.points.matches);
  segment.usable_lines.push_back(evidence.usable_lines.matches);
  segment.vertical_lines.push_back(evidence.vertical_lines.matches);
}

SegmentSessionRow Finish(const Session& session, SegmentId id, SegmentMatches segment) {
  SegmentSessionRow row = segment.row;
  row.session = session.id;
  row.session_start_unix_ns = session.start_unix_ns;
  row.segment = id;
  row.median_point_matches = MedianOrZero(std::move(segment.points));
  row.median_usable_line_matches = MedianOrZero(std::move(segment.usable_lines));
  row.median_vertical_line_matches = MedianOrZero(std::move(segment.vertical_lines));
  return row;
}

}  // namespace

std::vector<SegmentSessionRow> FoldObservations(const Session& session,
                                                std::span<const Observation> observations) {
  std::map<SegmentId, SegmentMatches> segments;
  for (const Observation& observation : observations) {
    if (observation.segment >= 0) Count(observation, segments[observation.segment]);
  }
  std::vector<SegmentSessionRow> rows;
  rows.reserve(segments.size());
  for (auto& [id, segment] : segments) rows.push_back(Finish(session, id, std::move(segment)));
  return rows;
}

}  // namespace maploc
