#include <iostream>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct StrategyFlags {
  std::string map;
  SegmentId segment = 0;
  std::string pin;  // a strategy's name; empty: left as it is
  bool unpin = false;
};

void Print(const CommandContext& context, const MapKey& key, const SegmentSummary& segment) {
  const StrategyDecision& decision = segment.decision;
  if (context.json) {
    PrintJson({{"map", key.name},
               {"segment", segment.id},
               {"strategy", StrategyName(decision.strategy)},
               {"strategy_source", StrategySourceName(decision.source)},
               {"predicted_success", decision.predicted_success},
               {"reason", decision.reason}});
    return;
  }
  std::cout << "segment " << segment.id << ": " << StrategyName(decision.strategy) << " ("
            << StrategySourceName(decision.source) << ")\n"
            << decision.reason << "\n";
}

Status ShowOrPin(const CommandContext& context, const StrategyFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, store->GetMap(flags.map));
  const MapKey& key = map.info.key;
  if (!flags.pin.empty()) {
    MAPLOC_RETURN_IF_ERROR(store->PinStrategy(key, flags.segment, StrategyFromName(flags.pin)));
  } else if (flags.unpin) {
    MAPLOC_RETURN_IF_ERROR(store->PinStrategy(key, flags.segment, std::nullopt));
  }
  MAPLOC_ASSIGN_OR_RETURN(const SegmentSummary segment, store->GetSegment(key, flags.segment));
  Print(context, key, segment);
  return Status::Ok();
}

}  // namespace

void AddStrategyCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<StrategyFlags>();
  CLI::App* command =
      AddCommand(app, context, "strategy", "Shows, pins or unpins a segment's strategy",
                 "maploc-map strategy --store campus.db --map campus --segment 3 --pin 2p",
                 [&context, flags] { return ShowOrPin(context, *flags); });
  AddMapOption(*command, flags->map);
  AddSegmentOption(*command, flags->segment);
  CLI::Option* pin = command
                         ->add_option("--pin", flags->pin,
                                      "Fix the strategy; a running server follows within a second")
                         ->check(CLI::IsMember({"1p1l", "2p", "mixed"}));
  command->add_flag("--unpin", flags->unpin, "Give it back to the selector")->excludes(pin);
}

}  // namespace maploc
