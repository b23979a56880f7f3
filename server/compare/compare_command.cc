#include <iostream>
#include <limits>
#include <memory>

#include <unistd.h>

#include "mapstore/tools/compare.h"
#include "mapstore/tools/output.h"
#include "server/compare/rerun.h"
#include "server/sessions/open_version.h"

namespace maploc {
namespace {

struct CompareFlags {
  std::string map;
  std::string recorded;
  std::vector<std::int64_t> versions;
  std::vector<std::string> strategies;
  RecordingFilter filter;
  int last = 200;
};

// Two versions, or one and two strategies.
std::string UsageFault(const CompareFlags& flags) {
  const std::size_t versions = flags.versions.size();
  const std::size_t strategies = flags.strategies.size();
  const bool two_versions = versions == 2 && strategies <= 1;
  const bool two_strategies = versions <= 1 && strategies == 2;
  if (two_versions || two_strategies) return "";
  return "give --version twice, or --strategy twice";
}

// `which` is 0 or 1. The only version or strategy that was given holds for both sides.
Result<Side> OpenSide(const MapStore& store, const CompareFlags& flags, std::size_t which,
                      SegmentCache& segments) {
  std::optional<std::int64_t> version;
  if (!flags.versions.empty()) version = flags.versions[std::min(which, flags.versions.size() - 1)];
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, FindMap(store, flags.map, version));
  Side side;
  MAPLOC_ASSIGN_OR_RETURN(side.map, OpenVersion(store, map.info, segments));
  if (!flags.strategies.empty()) {
    side.strategy =
        StrategyFromName(flags.strategies[std::min(which, flags.strategies.size() - 1)]);
  }
  return side;
}

void ShowProgress(int done, std::size_t of) {
  static const bool visible = isatty(STDERR_FILENO) != 0;
  if (!visible) return;
  std::cerr << "\r" << done << " of " << of << " queries"
            << (static_cast<std::size_t>(done) == of ? "\n" : "") << std::flush;
}

Status Compare(const CommandContext& context, const CompareFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  SegmentCache segments(store.get(), std::numeric_limits<std::int64_t>::max());
  MAPLOC_ASSIGN_OR_RETURN(const Side before, OpenSide(*store, flags, 0, segments));
  MAPLOC_ASSIGN_OR_RETURN(const Side after, OpenSide(*store, flags, 1, segments));
  MAPLOC_ASSIGN_OR_RETURN(const Recording recording, Recording::Open(flags.recorded));
  RecordingFilter filter = flags.filter;
  filter.map = flags.map;
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<RecordPosition> positions,
                          recording.FindLast(filter, static_cast<std::size_t>(flags.last)));
  MAPLOC_ASSIGN_OR_RETURN(const ChangeReport report,
                          Rerun(recording, positions, before, after,
                                [&](int done) { ShowProgress(done, positions.size()); }));
  context.json ? PrintJson(report.Json()) : report.Print(std::cout);
  return Status::Ok();
}

constexpr char kExample[] =
    "maploc-map compare --store campus.db --map yard --recorded recording --version 3 --version 4\n"
    "  maploc-map compare --store campus.db --map yard --recorded recording --strategy 1p1l "
    "--strategy mixed\n"
    "Before a staged version is enabled: what robots asked lately (maploc-server --recorder), "
    "answered by\n"
    "the version that they have and by the new one, without a server. `worse`: no longer "
    "localized, or the\n"
    "position's sigma is 1.05 times as large. `moved`: both localized, more than 3 sigmas apart; "
    "one is wrong.\n"
    "The verdict says what better and worse queries together prove (sign test, 5%).";

}  // namespace

void AddCompareCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<CompareFlags>();
  CLI::App* command = AddCommand(
      app, context, "compare",
      "Runs recorded queries against two versions or strategies: what got better, worse, moved",
      kExample, [&context, flags] { return Compare(context, *flags); });
  AddMapOption(*command, flags->map);
  command
      ->add_option("--recorded", flags->recorded,
                   "The folder of maploc-server --recorder, or a file of it; may be in use")
      ->required()
      ->type_name("PATH");
  command
      ->add_option("--version", flags->versions, "Twice: before, after; once: of both strategies")
      ->allow_extra_args(false)
      ->type_name("N");
  command
      ->add_option("--strategy", flags->strategies, "Twice: before, after; once: of both versions")
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"1p1l", "2p", "mixed", "p3p"}));
  command->add_option("--last", flags->last, "So many of the map's queries, the last ones")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--robot", flags->filter.robot, "Only of this robot")->type_name("NAME");
  command
      ->add_option("--outcome", flags->filter.outcome,
                   "Only with this recorded outcome: LOCALIZED, LOW_CONFIDENCE, DEADLINE_EXCEEDED")
      ->type_name("NAME");
  command->parse_complete_callback([flags] {
    const std::string fault = UsageFault(*flags);
    if (!fault.empty()) throw CLI::ValidationError(fault);
  });
}

}  // namespace maploc
