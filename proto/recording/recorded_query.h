// A recorded query, parsed and validated: what proto/convert checks of a request and an answer is
// checked here too, and nobody checks again. Pure; thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "mapstore/base/ids.h"
#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/query.h"

namespace maploc {

struct RecordedQuery {
  Query query;                                     // as the robot sent it
  Result<Localization> answer = Internal("none");  // or the error that it was refused with
  std::string robot;                               // empty: not known
  MapKey map;  // an empty name, version 0: not known (a refusal may come before)
  std::int64_t answered_unix_ns = 0;
  double total_ms = 0.0;
  int stands_for = 1;  // so many queries that were localized without doubt; it is one of them

  // The same to be run again: on the map that answered, outside of any session, so that nothing
  // counts twice, and in whatever version is there.
  Query ToRepeat() const;
};

// Errors that come of query and map, and not of the caller or of the server's load: those alone are
// recorded.
bool IsAboutTheQuery(StatusCode code);

// "LOCALIZED" and so on, or the code of the error.
std::string_view OutcomeText(const Result<Localization>& answer);

// INVALID_ARGUMENT names the field.
Result<RecordedQuery> RecordedQueryFromBytes(std::string_view record);

}  // namespace maploc
