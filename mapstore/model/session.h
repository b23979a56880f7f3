// Robot sessions and what they teach: an observation a query, one row a session and segment,
// statistics a segment.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapstore/base/ids.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/strategy.h"

namespace maploc {

enum class SessionEnd {
  kOpen = 0,     // not ended yet
  kByRobot = 1,  // EndSession
  kIdle = 2,     // the server closed it, after a time without queries
};

struct Session {
  SessionId id;
  MapKey map;  // fixed at the start: a session stays on its map version
  std::string robot;
  std::map<std::string, std::string> labels;  // free: season=autumn, light=night
  std::int64_t start_unix_ns = 0;
  std::int64_t end_unix_ns = 0;  // 0 while open
  SessionEnd end = SessionEnd::kOpen;
  bool revoked = false;
};

// One query's trace. (session, sequence) is its identity: appended twice, it counts once. So is
// (session, counted_as) where that is given: of two, the first one appended counts.
struct Observation {
  std::int64_t sequence = 0;  // given by the session, ascending from 1
  SegmentId segment = -1;     // -1: OUT_OF_MAP, counted in no segment
  Outcome outcome = Outcome::kNoConsensus;
  Evidence evidence;
  double total_ms = 0.0;
  std::int64_t time_unix_ns = 0;
  // Names the robot's query, so that it counts once however often it is sent. Empty: each one
  // counts.
  std::string counted_as;
};

// What one session teaches about one segment: sums over its queries. The truth; everything else is
// derived from these rows. A failed query counts in `queries` alone: its matches do not enter the
// ratios.
struct SegmentSessionRow {
  SessionId session;
  std::int64_t session_start_unix_ns = 0;  // rows fold in the order (start, session)
  SegmentId segment = 0;
  std::int64_t queries = 0;
  std::int64_t localized = 0;
  std::int64_t point_matches = 0;  // of localized queries
  std::int64_t point_inliers = 0;
  std::int64_t usable_line_matches = 0;
  std::int64_t usable_line_inliers = 0;
  std::int64_t vertical_line_matches = 0;
  std::int64_t vertical_line_inliers = 0;
  double median_point_matches = 0.0;  // a localized query
  double median_usable_line_matches = 0.0;
  double median_vertical_line_matches = 0.0;
  bool operator==(const SegmentSessionRow&) const = default;
};

// Derived from a segment's unrevoked rows, in their order, to the bit.
struct SegmentStatistics {
  std::int64_t sessions = 0;
  std::int64_t queries = 0;
  std::int64_t localized = 0;
  double point_matches = 0.0;  // weighted by age
  double point_inliers = 0.0;
  double usable_line_matches = 0.0;
  double usable_line_inliers = 0.0;
  double vertical_line_matches = 0.0;
  double vertical_line_inliers = 0.0;
  double typical_point_matches = 0.0;  // p, of a query (weighted mean of the sessions' medians)
  double typical_usable_line_matches = 0.0;    // l
  double typical_vertical_line_matches = 0.0;  // lv
  double weighted_queries = 0.0;               // weighted by age, as the matches
  double weighted_localized = 0.0;
  // How many independent matches the sums above are worth (those of one view, and the views of one
  // session, stand and fall together).
  double independent_points = 0.0;
  double independent_usable_lines = 0.0;
  double independent_vertical_lines = 0.0;
  bool operator==(const SegmentStatistics&) const = default;

  // lambda and gamma; nullopt before any match.
  std::optional<double> PointInlierRatio() const {
    if (point_matches <= 0) return std::nullopt;
    return point_inliers / point_matches;
  }
  std::optional<double> LineInlierRatio() const {
    const double matches = usable_line_matches + vertical_line_matches;
    if (matches <= 0) return std::nullopt;
    return (usable_line_inliers + vertical_line_inliers) / matches;
  }
};

// The strategy of a segment, with why.
struct StrategyDecision {
  Strategy strategy = Strategy::kMixed;
  StrategySource source = StrategySource::kDefault;
  std::string reason;              // one line for an operator
  double predicted_success = 0.0;  // of one iteration with `strategy`; 0 before evidence
  // All strategies that the selector knows: `strategy` first, then the others, best first. What a
  // query falls back to.
  std::array<Strategy, 3> ranking = {Strategy::kMixed, Strategy::k2P, Strategy::k1P1L};
  bool operator==(const StrategyDecision&) const = default;
};

// What an EndSession did, the same however often it is asked.
struct SessionSummary {
  struct SegmentChange {
    SegmentId segment = 0;
    std::int64_t queries = 0;
    std::int64_t localized = 0;
    Strategy strategy_before = Strategy::kMixed;
    Strategy strategy_after = Strategy::kMixed;
    bool operator==(const SegmentChange&) const = default;
  };
  SessionId session;
  SessionEnd end = SessionEnd::kByRobot;
  std::int64_t queries = 0;
  std::int64_t localized = 0;
  std::vector<SegmentChange> segments;  // ascending by segment; those visited
  bool operator==(const SessionSummary&) const = default;
};

}  // namespace maploc
