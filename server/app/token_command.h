// maploc-server token create|list|revoke: the tokens of a store, also while it is served.
#pragma once

namespace maploc {

// Whether the first argument is "token".
bool IsTokenCommand(int argc, const char* const* argv);

// Does it. A new token goes to standard output, once and nowhere else. Returns the exit code: 0
// done, 1 failed (one line on standard error), 2 wrong usage.
int RunTokenCommand(int argc, const char* const* argv);

}  // namespace maploc
