#pragma once

#include "tests/experiments/commands.h"

namespace maploc::lies {

// maploc-experiments lies: honest recorded queries, and the same with one input that lies.
CLI::App* AddLiesCommand(CLI::App& app, experiments::CommandContext& context);

}  // namespace maploc::lies
