#pragma once

#include "mapstore/tools/commands.h"

namespace maploc {

void AddRestoreCommand(CLI::App& app, CommandContext& context);

}  // namespace maploc
