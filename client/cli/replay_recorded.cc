#include "client/cli/replay_recorded.h"

#include <iostream>

#include "client/api/client.h"
#include "client/cli/output.h"
#include "proto/recording/change_report.h"

namespace maploc {
CLI::Option* AddRecordedFlags(CLI::App& command, RecordedFlags& flags) {
  CLI::Option* const recorded = command.add_option(
      "--recorded", flags.path,
      "instead of --colmap: what a server recorded (the folder of maploc-server --recorder, or a "
      "file of it), asked again outside of any session; told is what differs from the recorded "
      "answers. --map and --robot choose whose queries");
  command.add_option("--last", flags.last, "of the recorded queries so many, the last ones")
      ->check(CLI::Range(1, 1'000'000))
      ->needs(recorded)
      ->capture_default_str();
  command
      .add_option("--outcome", flags.filter.outcome,
                  "recorded queries with this outcome alone: LOCALIZED, NO_CONSENSUS, ...")
      ->needs(recorded);
  return recorded;
}

Status ReplayRecorded(const CommandContext& context, const RecordedFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const Client client, Connect(context));
  MAPLOC_ASSIGN_OR_RETURN(const Recording recording, Recording::Open(flags.path));
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<RecordPosition> positions,
                          recording.FindLast(flags.filter, static_cast<std::size_t>(flags.last)));
  ChangeReport report("recorded", "now");
  {
    Progress progress("replay", static_cast<int>(positions.size()));
    for (const RecordPosition& position : positions) {
      MAPLOC_ASSIGN_OR_RETURN(const RecordedQuery recorded, recording.Read(position));
      const Result<Localization> now = client.Localize(recorded.ToRepeat());
      // Any other error is of the connection, or of a map that this server does not have.
      if (!now.ok() && !IsAboutTheQuery(now.status().code())) return now.status();
      progress.Advance(std::string(ChangeName(report.Add(recorded, recorded.answer, now))));
    }
  }
  context.json ? PrintJson(report.Json()) : report.Print(std::cout);
  return Status::Ok();
}

}  // namespace maploc
