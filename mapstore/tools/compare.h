// maploc-map compare: recorded queries against two versions of a map. Defined in server/compare,
// because it runs the queries as the server does, and mapstore knows nothing of that.
#pragma once

#include "mapstore/tools/commands.h"

namespace maploc {

void AddCompareCommand(CLI::App& app, CommandContext& context);

}  // namespace maploc
