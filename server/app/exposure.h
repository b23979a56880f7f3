// Who can reach the server, and what that asks of its credentials.
#pragma once

#include "mapstore/base/status.h"
#include "server/app/options.h"

namespace maploc {

// INVALID_ARGUMENT (INSECURE) where other machines could reach it in the clear, unless `insecure`.
Status CheckExposure(const ServerOptions& options);
// Whether callers need a token also while there is none yet.
bool NeedsTokens(const ServerOptions& options);

}  // namespace maploc
