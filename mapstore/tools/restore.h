// `maploc-map restore`: puts a backup in the place of a store that nobody has open.
#pragma once

#include "mapstore/tools/commands.h"

namespace maploc {

void AddRestoreCommand(CLI::App& app, CommandContext& context);

}  // namespace maploc
