// What the store in memory keeps, and the store itself.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mapstore/store/carried.h"
#include "mapstore/store/derivation.h"
#include "mapstore/store/map_store.h"

namespace maploc {

struct InMemorySegment {
  std::shared_ptr<const Segment> segment;
  // In folding order, also those of revoked sessions.
  std::map<std::pair<std::int64_t, SessionId>, SegmentSessionRow> rows;
  std::vector<Pin> pins;
  SegmentState state;
  std::int64_t changed = 0;  // the change counter that told of it
};

struct InMemoryMap {
  MapSummary summary;
  bool deleted = false;                   // has rows, which others inherit, but no landmarks
  std::vector<InMemorySegment> segments;  // by id
  std::vector<Inheritance> inheritance;   // a source is a version of the same name
};

struct InMemorySession {
  Session session;
  std::map<std::int64_t, Observation> observations;  // by sequence
  SessionSummary summary;                            // once ended
};

// Idempotent by sequence and by counted_as.
void AddObservations(InMemorySession& session, std::span<const Observation> observations);
std::vector<Observation> InOrder(const std::map<std::int64_t, Observation>& observations);
SegmentSummary Summarize(const InMemorySegment& stored);
// What `map` inherits from the version before it.
std::vector<Inheritance> InheritanceOf(const InMemoryMap& map, const InMemoryMap& predecessor);

// Declared here because its sources are two: maps and sessions, and what is learned from them.
class InMemoryStore : public MapStore {
 public:
  explicit InMemoryStore(const StoreOptions& options) : options_(options) {}

  Result<std::vector<MapSummary>> ListMaps() const override;
  Result<MapSummary> GetMap(const std::string& name) const override;
  Result<MapSummary> GetMap(const MapKey& key) const override;
  Result<std::vector<MapSummary>> ListVersions() const override;
  Status EnableVersion(const MapKey& key, KeptVersions keep) override;
  Status DeleteVersion(const MapKey& key) override;
  Result<std::vector<SegmentSummary>> ListSegments(const MapKey& key) const override;
  Result<std::vector<SegmentSummary>> ListChangedSegments(const MapKey& key,
                                                          std::int64_t since) const override;
  Result<SegmentSummary> GetSegment(const MapKey& key, SegmentId id) const override;
  Result<std::shared_ptr<const Segment>> LoadSegment(const MapKey& key,
                                                     SegmentId id) const override;
  Result<std::vector<SegmentPlace>> LoadPlaces(const MapKey& key) const override;
  Result<std::unique_ptr<MapWriter>> BeginImport(const MapInfo& info) override;
  Status SweepAbandonedImports() override { return Status::Ok(); }
  Status StartSession(const Session& session) override;
  Result<Session> GetSession(const SessionId& id) const override;
  Result<std::vector<Session>> ListSessions() const override;
  Result<std::vector<SessionId>> AppendGroup(std::span<const SessionObservations> group) override;
  Result<std::vector<Observation>> ListObservations(const SessionId& id) const override;
  Result<SessionSummary> EndSession(const SessionId& id, SessionEnd end, std::int64_t end_unix_ns,
                                    std::span<const Observation> last) override;
  Status RevokeSession(const SessionId& id) override { return SetRevoked(id, true); }
  Status ReinstateSession(const SessionId& id) override { return SetRevoked(id, false); }
  Result<std::vector<SegmentSessionRow>> ListRows(const MapKey& key, SegmentId id) const override;
  Result<std::vector<DecisionRecord>> ListDecisions(const MapKey& key, SegmentId id) const override;
  Status PinStrategy(const MapKey& key, SegmentId id, std::optional<Strategy> pinned) override;
  Result<std::int64_t> ChangeCounter() const override;
  Status CheckIdentity() const override { return Status::Ok(); }
  Status Verify() const override;

  // For the writer.
  void Publish(InMemoryMap map, const Publishing& publishing);
  void Abandon(const MapKey& key);
  const SelectorOptions& selector() const { return options_.selector; }

 private:
  // REQUIRES: mutex_ is held (all of them).
  Result<const InMemoryMap*> FindMap(const MapKey& key) const;
  const InMemoryMap* FindPredecessor(const MapKey& heir) const;
  void Enable(const MapKey& key);
  std::int64_t CountOpenSessions(const MapKey& key) const;
  static void Delete(InMemoryMap& map);
  void DeleteOlder(const std::string& name, KeptVersions keep);
  Result<const InMemorySegment*> FindSegment(const MapKey& key, SegmentId id) const;
  Status SetRevoked(const SessionId& id, bool revoked);
  Status CheckObservations(const Session& session, std::span<const Observation> observations) const;
  Result<SegmentTruth> FindTruth(const MapKey& key, SegmentId id) const;
  std::vector<TrueRow> RowsOf(const InMemoryMap& map, SegmentId id) const;
  SegmentTruth TruthOf(const InMemoryMap& map, SegmentId id) const;
  void Derive(InMemoryMap& map, SegmentId id) const;
  void DeriveVisited(const InMemorySession& session);

  const StoreOptions options_;
  mutable std::mutex mutex_;
  std::map<MapKey, InMemoryMap> maps_;
  std::set<MapKey> imports_;  // versions that are given but not published
  std::map<SessionId, InMemorySession> sessions_;
  std::int64_t change_counter_ = 0;
};

}  // namespace maploc
