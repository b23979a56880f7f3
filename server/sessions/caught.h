// Failure is a value here; what is thrown all the same comes from below (no memory, a library's
// accident) and must not leave a thread: the process would abort, and every robot lose its server.
#pragma once

#include <exception>

#include "mapstore/base/status.h"

namespace maploc {

// What `call` returns, a Status or a Result; INTERNAL with what it throws.
template <typename Call>
auto Caught(const Call& call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::exception& error) {
    return Internal(error.what());
  } catch (...) {
    return Internal("an exception without a name");
  }
}

}  // namespace maploc
