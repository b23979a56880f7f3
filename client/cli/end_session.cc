#include <iostream>
#include <memory>

#include "client/api/client.h"
#include "client/cli/commands.h"
#include "client/cli/output.h"
#include "client/cli/replay_report.h"

namespace maploc {
namespace {

constexpr char kExample[] =
    "  maploc end-session --server 127.0.0.1:50051 --session 3f9c0d52b7e841a6c1f80a9d4e6b2735";

Status Run(const CommandContext& context, const SessionId& session) {
  MAPLOC_ASSIGN_OR_RETURN(const Client client, Connect(context));
  MAPLOC_ASSIGN_OR_RETURN(const SessionSummary summary, client.EndSession(session));
  context.json ? PrintJson(SummaryJson(summary)) : PrintSummary(summary, std::cout);
  return Status::Ok();
}

}  // namespace

void AddEndSessionCommand(CLI::App& app, CommandContext& context) {
  auto session = std::make_shared<SessionId>();
  CLI::App* command =
      AddCommand(app, context, "end-session",
                 "End a session; ended once more, it answers the same and changes nothing",
                 kExample, [&context, session] { return Run(context, *session); });
  AddServerFlag(*command, context)->required();
  command->add_option("--session", *session, "the session's whole id, as replay prints it")
      ->required();
}

}  // namespace maploc
