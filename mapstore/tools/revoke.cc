#include <iostream>
#include <set>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct RevokeFlags {
  std::string session;
  bool undo = false;
};

struct Change {
  SegmentId segment = 0;
  StrategyDecision before;
  StrategyDecision after;
};

// The segments that the session saw, as they are now.
Result<std::vector<SegmentSummary>> VisitedSegments(const MapStore& store, const Session& session) {
  // A deleted version has no segments to show, but newer versions inherit from its sessions.
  const Status map = store.GetMap(session.map).status();
  if (map.code() == StatusCode::kNotFound) return std::vector<SegmentSummary>();
  MAPLOC_RETURN_IF_ERROR(map);
  MAPLOC_ASSIGN_OR_RETURN(const auto observations, store.ListObservations(session.id));
  std::set<SegmentId> visited;
  for (const Observation& observation : observations) visited.insert(observation.segment);
  // -1 stands for queries in no segment.
  visited.erase(-1);
  std::vector<SegmentSummary> segments;
  for (const SegmentId id : visited) {
    MAPLOC_ASSIGN_OR_RETURN(SegmentSummary segment, store.GetSegment(session.map, id));
    segments.push_back(std::move(segment));
  }
  return segments;
}

Result<std::vector<Change>> Apply(MapStore& store, const Session& session, bool undo) {
  MAPLOC_ASSIGN_OR_RETURN(const auto before, VisitedSegments(store, session));
  MAPLOC_RETURN_IF_ERROR(undo ? store.ReinstateSession(session.id)
                              : store.RevokeSession(session.id));
  std::vector<Change> changes;
  for (const SegmentSummary& segment : before) {
    MAPLOC_ASSIGN_OR_RETURN(const SegmentSummary after, store.GetSegment(session.map, segment.id));
    changes.push_back({segment.id, segment.decision, after.decision});
  }
  return changes;
}

nlohmann::ordered_json ToJson(const Session& session, bool undo,
                              const std::vector<Change>& changes) {
  auto segments = nlohmann::ordered_json::array();
  for (const Change& change : changes) {
    segments.push_back({{"segment", change.segment},
                        {"strategy_before", StrategyName(change.before.strategy)},
                        {"strategy_after", StrategyName(change.after.strategy)}});
  }
  return {{"session", session.id},
          {"revoked", !undo},
          {"changed", session.revoked == undo},
          {"map", session.map.name},
          {"version", session.map.version},
          {"segments", std::move(segments)}};
}

void PrintText(const Session& session, bool undo, const std::vector<Change>& changes) {
  std::cout << "Session " << session.id << " of robot " << session.robot
            << (undo ? " counts again" : " no longer counts")
            << (session.revoked == undo ? "" : " (as before)") << ".\n";
  if (!undo && session.end == SessionEnd::kOpen) {
    std::cout << "It is still open; its queries go on and will not count either.\n";
  }
  for (const Change& change : changes) {
    if (change.before.strategy == change.after.strategy) continue;
    std::cout << "segment " << change.segment << ": " << StrategyName(change.before.strategy)
              << " -> " << StrategyName(change.after.strategy) << "\n";
  }
}

Status Revoke(const CommandContext& context, const RevokeFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  // As it was before, so that the report can say whether anything changed.
  MAPLOC_ASSIGN_OR_RETURN(const Session session, store->GetSession(flags.session));
  MAPLOC_ASSIGN_OR_RETURN(const auto changes, Apply(*store, session, flags.undo));
  if (context.json) return PrintJson(ToJson(session, flags.undo, changes)), Status::Ok();
  PrintText(session, flags.undo, changes);
  return Status::Ok();
}

}  // namespace

void AddRevokeCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<RevokeFlags>();
  CLI::App* command = AddCommand(app, context, "revoke", "Excludes a session from all statistics",
                                 "maploc-map revoke --store campus.db --session "
                                 "3f9c0d52b7e841a6c1f80a9d4e6b2735\n"
                                 "A running server follows within a second.",
                                 [&context, flags] { return Revoke(context, *flags); });
  command
      ->add_option("--session", flags->session, "The session's whole id, as `sessions` lists them")
      ->required()
      ->type_name("ID");
  command->add_flag("--undo", flags->undo, "Let it count again");
}

}  // namespace maploc
