#include "server/recorder/choice.h"

#include <string_view>

#include "maploc/recording/v1/recording.pb.h"
#include "proto/recording/recorded_query.h"

namespace maploc {
namespace {

// Failed preconditions that say nothing about a map; its name is then as the caller wrote it.
bool IsCallersMistake(std::string_view reason) {
  return reason == "SESSION_CLOSED" || reason == "MAP_VERSION_MISMATCH";
}

}  // namespace

Interest InterestOf(const recording::v1::RecordedQuery& query) {
  if (!query.has_answer()) {
    const auto code = static_cast<StatusCode>(query.refusal().code());
    // Nobody could run again what has no map.
    const bool can_be_run = IsAboutTheQuery(code) && !query.map().empty();
    return can_be_run && !IsCallersMistake(query.refusal().reason()) ? Interest::kUnusual
                                                                     : Interest::kNone;
  }
  const v1::LocalizeResponse& answer = query.answer();
  const bool is_doubtful = answer.outcome() != v1::OUTCOME_LOCALIZED || answer.gravity_rejected() ||
                           answer.confidence() < kWithoutDoubt;
  return is_doubtful ? Interest::kUnusual : Interest::kUsual;
}

}  // namespace maploc
