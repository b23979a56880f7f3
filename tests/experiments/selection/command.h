// `maploc-experiments selection`.
#pragma once

#include "tests/experiments/commands.h"

namespace maploc::selection {

CLI::App* AddSelectionCommand(CLI::App& app, experiments::CommandContext& context);

}  // namespace maploc::selection
