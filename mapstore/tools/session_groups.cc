#include "mapstore/tools/session_groups.h"

#include <algorithm>
#include <map>
#include <utility>

#include "mapstore/tools/unmoved.h"

namespace maploc {
namespace {

// With the options that the stored statistics were derived with.
Status CheckRecomputed(const SegmentSummary& segment, const std::vector<SegmentSessionRow>& rows) {
  if (Aggregate(rows, segment.selector.statistics) == segment.statistics) return Status::Ok();
  return Status(StatusCode::kDataLoss, "DAMAGED_STORE",
                "segment " + std::to_string(segment.id) +
                    ": its statistics differ from its sessions' rows; restore the store from a "
                    "backup");
}

bool HasLabels(const Session& session, const std::vector<std::string>& labels) {
  return std::all_of(labels.begin(), labels.end(), [&](const std::string& label) {
    // The flag's check has made sure that it is there (stats.cc).
    const std::size_t split = label.find('=');
    const auto found = session.labels.find(label.substr(0, split));
    return found != session.labels.end() && found->second == label.substr(split + 1);
  });
}

std::optional<std::string> ValueOf(const Session& session, const std::string& key) {
  const auto found = session.labels.find(key);
  if (found == session.labels.end()) return std::nullopt;
  return found->second;
}

// The chosen sessions, by the value of the label of `by`; without it all under one.
using Selection = std::map<std::optional<std::string>, std::map<SessionId, MapKey>>;

Result<Selection> Select(const MapStore& store, const std::string& map,
                         const GroupOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(const auto sessions, store.ListSessions());
  Selection selection;
  // Also without any session: the segments are then listed with zeros.
  if (options.by.empty()) selection.try_emplace(std::nullopt);
  for (const Session& session : sessions) {
    if (session.map.name != map || !HasLabels(session, options.labels)) continue;
    const auto value = options.by.empty() ? std::nullopt : ValueOf(session, options.by);
    selection[value].emplace(session.id, session.map);
  }
  return selection;
}

// `summary` of the chosen sessions alone.
SegmentStats StatsOf(SegmentSummary summary, std::vector<SegmentSessionRow> rows,
                     const std::map<SessionId, MapKey>& chosen, const MapKey& key) {
  std::erase_if(rows, [&](const SegmentSessionRow& row) { return !chosen.contains(row.session); });
  SegmentStats stats;
  const StatisticsOptions& options = summary.selector.statistics;
  summary.statistics = Aggregate(rows, options);
  stats.changes = FindChanges(rows, options);
  stats.summary = std::move(summary);
  stats.inherited_sessions =
      std::count_if(rows.begin(), rows.end(),
                    [&](const SegmentSessionRow& row) { return chosen.at(row.session) != key; });
  return stats;
}

// In several transactions, between which a session may end.
Result<std::vector<SessionGroup>> ReadOnce(const MapStore& store, const MapKey& key,
                                           const GroupOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(const Selection selection, Select(store, key.name, options));
  std::vector<SessionGroup> groups;
  for (const auto& [value, chosen] : selection) groups.push_back({value, {}});
  MAPLOC_ASSIGN_OR_RETURN(const auto segments, store.ListSegments(key));
  for (const SegmentSummary& segment : segments) {
    MAPLOC_ASSIGN_OR_RETURN(const auto rows, store.ListRows(key, segment.id));
    if (options.recompute) MAPLOC_RETURN_IF_ERROR(CheckRecomputed(segment, rows));
    auto group = groups.begin();
    for (const auto& [value, chosen] : selection) {
      (group++)->segments.push_back(StatsOf(segment, rows, chosen, key));
    }
  }
  return groups;
}

}  // namespace

Result<std::vector<SessionGroup>> ReadGroups(const MapStore& store, const MapKey& key,
                                             const GroupOptions& options) {
  return ReadUnmoved(store, [&] { return ReadOnce(store, key, options); });
}

}  // namespace maploc
