#include "server/recorder/choice.h"

#include "maploc/recording/v1/recording.pb.h"
#include "proto/recording/recorded_query.h"

namespace maploc {

Interest InterestOf(const recording::v1::RecordedQuery& query) {
  if (!query.has_answer()) {
    const auto code = static_cast<StatusCode>(query.refusal().code());
    // Nobody could run again what has no map.
    return IsAboutTheQuery(code) && !query.map().empty() ? Interest::kUnusual : Interest::kNone;
  }
  const v1::LocalizeResponse& answer = query.answer();
  const bool is_doubtful = answer.outcome() != v1::OUTCOME_LOCALIZED || answer.gravity_rejected() ||
                           answer.confidence() < kWithoutDoubt;
  return is_doubtful ? Interest::kUnusual : Interest::kUsual;
}

}  // namespace maploc
