// The store's interface: maps and their segments, sessions and their observations, statistics and
// strategies. One contract suite (tests/contract) holds for every implementation.
//
// Thread-safe: every method may be called from any thread. Reads see what was committed before they
// began. A write is one transaction: when it returns ok it is on disk, when it does not nothing has
// changed. Unknown things are NOT_FOUND.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mapstore/base/ids.h"
#include "mapstore/base/status.h"
#include "mapstore/descriptors/segment_place.h"
#include "mapstore/model/map.h"
#include "mapstore/model/session.h"
#include "mapstore/statistics/selector.h"

namespace maploc {

struct MapSummary {
  MapInfo info;
  bool enabled = false;  // the one version of its name that robots get
  // Rises with each version of a name that is enabled, so that the second largest was enabled
  // before; 0: not yet.
  std::int64_t enabled_order = 0;
  std::int64_t segments = 0;
  std::int64_t points = 0;  // distinct landmarks in all segments
  std::int64_t lines = 0;
  std::int64_t usable_lines = 0;
};

struct SegmentSummary {
  SegmentId id = 0;
  std::int64_t points = 0;
  std::int64_t lines = 0;
  std::int64_t usable_lines = 0;
  std::vector<Eigen::Vector3d> path_in_map;
  SegmentStatistics statistics;
  StrategyDecision decision;
  std::optional<Strategy> pinned;
  SelectorOptions selector;  // that statistics and decision were derived with
};

// One entry of a segment's history of decisions.
struct DecisionRecord {
  std::int64_t time_unix_ns = 0;  // the end of the session; when the pin was given
  std::string cause;              // the session's id, "pin" or "unpin"
  StrategyDecision decision;
  SegmentStatistics statistics;  // at that time
  bool operator==(const DecisionRecord&) const = default;
};

// Of a store, however it keeps its data.
struct StoreOptions {
  SelectorOptions selector;  // for statistics and strategies derived from now on
};

// What one session has to append.
struct SessionObservations {
  SessionId session;
  std::vector<Observation> observations;
};

// How many of a map's older DISABLED versions stay where a version is published or enabled; none:
// all. Of those older than the enabled version, the ones that were enabled last, then the newest,
// are kept; the others are deleted in the same transaction, as DeleteVersion does, except those
// that open sessions use.
using KeptVersions = std::optional<int>;

// How an import becomes a version.
struct Publishing {
  bool enable = true;  // robots get it, unless by then a newer one is enabled
  KeptVersions keep_versions;
};

// An import in progress, invisible to readers until Commit. Without Commit nothing remains of it.
// Must not outlive its store. Not thread-safe.
class MapWriter {
 public:
  virtual ~MapWriter() = default;
  // The name and the version that Commit will publish.
  virtual const MapKey& key() const = 0;
  // REQUIRES: ids ascend from 0 without gaps. The segment is validated (ValidateSegment); its `map`
  // is ignored. One short transaction a segment.
  virtual Status AddSegment(const Segment& segment) = 0;
  // Publishes the version, with the counts of distinct landmarks. At most once.
  // FAILED_PRECONDITION (EMPTY_MAP) without a segment.
  virtual Status Commit(const Publishing& publishing = {}) = 0;
};

class MapStore {
 public:
  virtual ~MapStore() = default;

  // Enabled version of each map, by name.
  virtual Result<std::vector<MapSummary>> ListMaps() const = 0;
  // Enabled version.
  virtual Result<MapSummary> GetMap(const std::string& name) const = 0;
  virtual Result<MapSummary> GetMap(const MapKey& key) const = 0;
  // Every version of every map, also those that are not enabled, by name, then version.
  virtual Result<std::vector<MapSummary>> ListVersions() const = 0;
  // From now on this is the version of its name that robots get. Sessions stay on theirs. Nothing
  // but `keep` has an effect where it is enabled already.
  virtual Status EnableVersion(const MapKey& key, KeptVersions keep = std::nullopt) = 0;
  // Deletes a version's landmarks, and gives their space back. Its sessions and what they taught
  // the versions that inherit from it stay. FAILED_PRECONDITION (MAP_ENABLED) for the
  // enabled version, (MAP_IN_USE) where a session on it is open.
  virtual Status DeleteVersion(const MapKey& key) = 0;
  virtual Result<std::vector<SegmentSummary>> ListSegments(const MapKey& key) const = 0;
  // Those whose statistics or strategy have changed since ChangeCounter() was `since`, by id. More
  // than these at times, never fewer. Costs nothing for the others.
  virtual Result<std::vector<SegmentSummary>> ListChangedSegments(const MapKey& key,
                                                                  std::int64_t since) const = 0;
  virtual Result<SegmentSummary> GetSegment(const MapKey& key, SegmentId id) const = 0;
  // The landmarks. DATA_LOSS where a blob's length does not fit its count.
  virtual Result<std::shared_ptr<const Segment>> LoadSegment(const MapKey& key,
                                                             SegmentId id) const = 0;
  // What place recognition needs of each segment, by id; written with it, and read without its
  // landmarks. DATA_LOSS as above.
  virtual Result<std::vector<SegmentPlace>> LoadPlaces(const MapKey& key) const = 0;

  // Starts an import of a new version of info.key.name (info.key.version is ignored).
  virtual Result<std::unique_ptr<MapWriter>> BeginImport(const MapInfo& info) = 0;
  // Deletes what is left of imports whose process has ended.
  virtual Status SweepAbandonedImports() = 0;

  // REQUIRES: session.end == kOpen. ALREADY_EXISTS for a known id.
  virtual Status StartSession(const Session& session) = 0;
  virtual Result<Session> GetSession(const SessionId& id) const = 0;
  // By start, then id.
  virtual Result<std::vector<Session>> ListSessions() const = 0;
  // To several sessions in ONE transaction, so that they share a sync of the disk. Idempotent by
  // (session, sequence) and by (session, counted_as): the first one appended stays. Segments must
  // exist (or be -1). Sessions that have ended are left out, and returned; any other error fails
  // the whole group.
  virtual Result<std::vector<SessionId>> AppendGroup(
      std::span<const SessionObservations> group) = 0;
  // All that was appended, ascending by sequence, but Evidence::focal_scale, which is not kept.
  virtual Result<std::vector<Observation>> ListObservations(const SessionId& id) const = 0;
  // ONE transaction: `last` is appended (idempotent), the session's observations fold into rows,
  // the visited segments' statistics and strategies are derived anew, the summary is kept.
  // Repeated: the kept summary, and nothing changes. What segments then know and have decided
  // depends on the sessions that have ended, not on the order in which they did.
  virtual Result<SessionSummary> EndSession(const SessionId& id, SessionEnd end,
                                            std::int64_t end_unix_ns,
                                            std::span<const Observation> last) = 0;
  // ONE transaction: from now on the session counts nowhere, and every statistic, decision and
  // history is what it would be had the session never been, to the bit; its observations and its
  // summary stay. Pins stay. An open session goes on and will not count when it ends. Repeated:
  // nothing changes.
  virtual Status RevokeSession(const SessionId& id) = 0;
  // Undoes a revoke completely.
  virtual Status ReinstateSession(const SessionId& id) = 0;
  // A segment's unrevoked rows in folding order (start, session).
  virtual Result<std::vector<SegmentSessionRow>> ListRows(const MapKey& key,
                                                          SegmentId id) const = 0;
  // The decisions about a segment, oldest first: one after each unrevoked session and one for each
  // pin, as they follow from the sessions in the order of their starts (a pin comes after those
  // that started before it). A session that ends late takes its place among them. The last one is
  // in force.
  virtual Result<std::vector<DecisionRecord>> ListDecisions(const MapKey& key,
                                                            SegmentId id) const = 0;
  // Fixes a segment's strategy, or gives it back to the selector (nullopt).
  virtual Status PinStrategy(const MapKey& key, SegmentId id, std::optional<Strategy> pinned) = 0;

  // Rises with every committed change that a cache of maps or strategies must see, also by other
  // processes. Cheap.
  virtual Result<std::int64_t> ChangeCounter() const = 0;
  // UNAVAILABLE (STORE_REPLACED) if the store that was opened has been replaced or deleted. Every
  // read and write then fails in the same way. Cheap.
  virtual Status CheckIdentity() const = 0;
  // What would change anything is FAILED_PRECONDITION (STORE_READ_ONLY).
  virtual bool read_only() const { return false; }
  // Reads everything and checks every invariant; names what is broken.
  virtual Status Verify() const = 0;
};

}  // namespace maploc
