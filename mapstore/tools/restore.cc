#include "mapstore/tools/restore.h"

#include <iostream>

#include "mapstore/store/restore.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

Status Restore(const CommandContext& context, const std::string& from) {
  MAPLOC_RETURN_IF_ERROR(CheckFrom(from));
  MAPLOC_ASSIGN_OR_RETURN(const RestoredStore restored,
                          RestoreSqliteStore(context.store_path, from));
  if (context.json) {
    PrintJson({{"store", context.store_path},
               {"from", from},
               {"maps", restored.maps},
               {"versions", restored.versions},
               {"sessions", restored.sessions}});
  } else {
    std::cout << context.store_path << " is now " << from << ": " << restored.maps << " maps in "
              << restored.versions << " versions, " << restored.sessions << " sessions.\n";
  }
  return Status::Ok();
}

}  // namespace

void AddRestoreCommand(CLI::App& app, CommandContext& context) {
  auto from = std::make_shared<std::string>();
  CLI::App* command =
      AddCommand(app, context, "restore",
                 "Puts a verified copy of a backup in the store's place, while no server uses it",
                 "maploc-map restore --store campus.db --from campus-monday.db",
                 [&context, from] { return Restore(context, *from); });
  command->add_option("--from", *from, "The backup; it stays as it is")
      ->required()
      ->type_name("FILE");
}

}  // namespace maploc
