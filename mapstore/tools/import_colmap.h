// maploc-map import-colmap: a COLMAP model into a store.
#pragma once

#include "mapstore/tools/commands.h"

namespace maploc {

void AddImportColmap(CLI::App& app, CommandContext& context);

}  // namespace maploc
