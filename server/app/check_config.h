// maploc-server --check-config: what a start would use and refuse, without starting. Nothing is
// made, changed or locked, so that it may be asked beside a server that runs; whether the ports are
// free is not looked at.
#pragma once

#include <string>
#include <vector>

#include "server/app/options.h"
#include "server/app/parse_all.h"

namespace maploc {

// Prints the options with their values and where these come from, and the faults of the command
// line and of what it names: addresses, certificates, tokens, the store. Exit code 1 if there is
// one.
int CheckConfig(const ServerOptions& options, ParsedOptions parsed, bool json);

}  // namespace maploc
