// Which queries are recorded. Internal to server/recorder.
#pragma once

namespace maploc::recording::v1 {
class RecordedQuery;
}  // namespace maploc::recording::v1

namespace maploc {

// A pose with less is recorded each time. The server tells none below 0.99 (--min-confidence).
inline constexpr double kWithoutDoubt = 0.999;

enum class Interest {
  kNone,    // refused for a reason that is the caller's or the load's
  kUsual,   // localized
  kUnusual  // refused, not localized, or localized with a doubt
};

// Pure; thread-safe.
Interest InterestOf(const recording::v1::RecordedQuery& query);

}  // namespace maploc
