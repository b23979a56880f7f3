// A store that hands everything on to another one: tests override what shall fail or be watched.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapstore/store/map_store.h"

namespace maploc::testing {

class ForwardingStore : public MapStore {
 public:
  explicit ForwardingStore(MapStore* store) : store_(store) {}

  Result<std::vector<MapSummary>> ListMaps() const override { return store_->ListMaps(); }
  Result<MapSummary> GetMap(const std::string& name) const override { return store_->GetMap(name); }
  Result<MapSummary> GetMap(const MapKey& key) const override { return store_->GetMap(key); }
  Result<std::vector<MapSummary>> ListVersions() const override { return store_->ListVersions(); }
  Status EnableVersion(const MapKey& key, KeptVersions keep) override {
    return store_->EnableVersion(key, keep);
  }
  Status DeleteVersion(const MapKey& key) override { return store_->DeleteVersion(key); }
  Result<std::vector<SegmentSummary>> ListSegments(const MapKey& key) const override {
    return store_->ListSegments(key);
  }
  Result<std::vector<SegmentSummary>> ListChangedSegments(const MapKey& key,
                                                          std::int64_t since) const override {
    return store_->ListChangedSegments(key, since);
  }
  Result<SegmentSummary> GetSegment(const MapKey& key, SegmentId id) const override {
    return store_->GetSegment(key, id);
  }
  Result<std::shared_ptr<const Segment>> LoadSegment(const MapKey& key,
                                                     SegmentId id) const override {
    return store_->LoadSegment(key, id);
  }
  Result<std::vector<SegmentPlace>> LoadPlaces(const MapKey& key) const override {
    return store_->LoadPlaces(key);
  }
  Result<std::unique_ptr<MapWriter>> BeginImport(const MapInfo& info) override {
    return store_->BeginImport(info);
  }
  Status SweepAbandonedImports() override { return store_->SweepAbandonedImports(); }
  Status StartSession(const Session& session) override { return store_->StartSession(session); }
  Result<Session> GetSession(const SessionId& id) const override { return store_->GetSession(id); }
  Result<std::vector<Session>> ListSessions() const override { return store_->ListSessions(); }
  Result<std::vector<SessionId>> AppendGroup(std::span<const SessionObservations> group) override {
    return store_->AppendGroup(group);
  }
  Result<std::vector<Observation>> ListObservations(const SessionId& id) const override {
    return store_->ListObservations(id);
  }
  Result<SessionSummary> EndSession(const SessionId& id, SessionEnd end, std::int64_t end_unix_ns,
                                    std::span<const Observation> last) override {
    return store_->EndSession(id, end, end_unix_ns, last);
  }
  Status RevokeSession(const SessionId& id) override { return store_->RevokeSession(id); }
  Status ReinstateSession(const SessionId& id) override { return store_->ReinstateSession(id); }
  Result<std::vector<SegmentSessionRow>> ListRows(const MapKey& key, SegmentId id) const override {
    return store_->ListRows(key, id);
  }
  Result<std::vector<DecisionRecord>> ListDecisions(const MapKey& key,
                                                    SegmentId id) const override {
    return store_->ListDecisions(key, id);
  }
  Status PinStrategy(const MapKey& key, SegmentId id, std::optional<Strategy> pinned) override {
    return store_->PinStrategy(key, id, pinned);
  }
  Result<std::int64_t> ChangeCounter() const override { return store_->ChangeCounter(); }
  Status CheckIdentity() const override { return store_->CheckIdentity(); }
  bool read_only() const override { return store_->read_only(); }
  Status Verify() const override { return store_->Verify(); }

 protected:
  MapStore* const store_;
};

}  // namespace maploc::testing
