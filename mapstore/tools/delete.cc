#include <iostream>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct DeleteFlags {
  std::string map;
  std::int64_t version = 0;
};

Status Delete(const CommandContext& context, const DeleteFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_RETURN_IF_ERROR(store->DeleteVersion({flags.map, flags.version}));
  if (context.json) {
    PrintJson({{"map", flags.map}, {"version", flags.version}, {"deleted", true}});
  } else {
    std::cout << "Map " << flags.map << " version " << flags.version
              << " is deleted; its space in the store serves later imports.\n";
  }
  return Status::Ok();
}

}  // namespace

void AddDeleteCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<DeleteFlags>();
  CLI::App* command = AddCommand(
      app, context, "delete", "Deletes the landmarks of a version that is not enabled",
      "maploc-map delete --store campus.db --map yard --version 2\n"
      "What its sessions taught stays with the versions that inherit from it. Refused while a "
      "session on it is open.",
      [&context, flags] { return Delete(context, *flags); });
  AddMapOption(*command, flags->map);
  AddRequiredVersionOption(*command, flags->version);
}

}  // namespace maploc
