#include <iostream>

#include "mapstore/store/sqlite_store.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

Status Backup(const CommandContext& context, const std::string& to) {
  MAPLOC_RETURN_IF_ERROR(BackupSqliteStore(context.store_path, to));
  if (context.json) {
    PrintJson({{"store", context.store_path}, {"backup", to}});
  } else {
    std::cout << "Copied " << context.store_path << " to " << to << ".\n";
  }
  return Status::Ok();
}

}  // namespace

void AddBackupCommand(CLI::App& app, CommandContext& context) {
  // Shared with the callback, because CLI11 writes into it after this function has returned.
  auto to = std::make_shared<std::string>();
  CLI::App* command = AddCommand(app, context, "backup",
                                 "Copies the store, also while a server uses it, to a new file",
                                 "maploc-map backup --store campus.db --to campus-monday.db",
                                 [&context, to] { return Backup(context, *to); });
  command->add_option("--to", *to, "The copy's file; must not exist")
      ->required()
      ->type_name("FILE");
}

}  // namespace maploc
