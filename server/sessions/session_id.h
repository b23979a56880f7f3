// The names of sessions.
#pragma once

#include "mapstore/base/ids.h"
#include "mapstore/base/status.h"

namespace maploc {

// 128 bits from the kernel's generator as 32 hexadecimal digits: knowing one id says nothing about
// another, so a robot cannot end somebody else's session. Thread-safe.
Result<SessionId> NewSessionId();

}  // namespace maploc
