// Reads that take several transactions, beside a server that goes on writing.
#pragma once

#include <cstdint>
#include <type_traits>

#include "mapstore/store/map_store.h"

namespace maploc {

// The answer of `read`, which returns a Status or a Result and reads `store` in as many calls as it
// likes, from a store that did not change in between: else it is read anew. An answer, or an error,
// from a store that moved is never given, for its parts may contradict each other.
// UNAVAILABLE (STORE_MOVES) when the store changed during each of many tries.
template <typename Read>
std::invoke_result_t<Read> ReadUnmoved(const MapStore& store, const Read& read) {
  constexpr int kTries = 20;
  for (int i = 0; i < kTries; ++i) {
    MAPLOC_ASSIGN_OR_RETURN(const std::int64_t before, store.ChangeCounter());
    std::invoke_result_t<Read> answer = read();
    MAPLOC_ASSIGN_OR_RETURN(const std::int64_t after, store.ChangeCounter());
    if (before == after) return answer;
  }
  return Status(StatusCode::kUnavailable, "STORE_MOVES",
                "the store changed during each of " + std::to_string(kTries) +
                    " reads, as sessions ended on it; repeat this when the server is less busy, or "
                    "ask a copy made by maploc-map backup");
}

}  // namespace maploc
