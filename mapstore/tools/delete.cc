#include <filesystem>
#include <iostream>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct DeleteFlags {
  std::string map;
  std::int64_t version = 0;
};

std::uintmax_t BytesOf(const std::string& path) {
  std::error_code none;
  const std::uintmax_t bytes = std::filesystem::file_size(path, none);
  return none ? 0 : bytes;
}

Status Delete(const CommandContext& context, const DeleteFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  const std::uintmax_t before = BytesOf(context.store_path);
  MAPLOC_RETURN_IF_ERROR(store->DeleteVersion({flags.map, flags.version}));
  const std::uintmax_t after = BytesOf(context.store_path);
  if (context.json) {
    PrintJson({{"map", flags.map},
               {"version", flags.version},
               {"deleted", true},
               {"store_bytes_before", before},
               {"store_bytes", after}});
  } else {
    std::cout << "Map " << flags.map << " version " << flags.version
              << " is deleted; the store's file had " << before << " bytes and has " << after
              << "."
              // The log keeps what a reader may still look up.
              << (after < before ? "" : " It becomes smaller when whoever reads it now is done.")
              << '\n';
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
