#include <iostream>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

Status Verify(const CommandContext& context) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_RETURN_IF_ERROR(store->Verify());
  if (context.json) {
    PrintJson({{"store", context.store_path}, {"ok", true}});
  } else {
    std::cout << context.store_path << ": every map, session and statistic is in order.\n";
  }
  return Status::Ok();
}

}  // namespace

void AddVerifyCommand(CLI::App& app, CommandContext& context) {
  AddCommand(app, context, "verify", "Reads the whole store and checks every invariant",
             "maploc-map verify --store campus.db", [&context] { return Verify(context); });
}

}  // namespace maploc
