#include "server/compare/rerun.h"

#include <utility>

#include "mapstore/importers/parallel.h"
#include "server/pipeline/localizer.h"

namespace maploc {
namespace {

struct Compared {
  Status status;  // of reading the query
  RecordedQuery recorded;
  Result<Localization> before = Internal("not run");
  Result<Localization> after = Internal("not run");
};

Result<Localization> RunOn(const Side& side, Query query) {
  if (side.strategy) query.requested_strategy = side.strategy;
  Result<Localization> answer =
      Localize(query, *side.map, LocalizerOptions(), kNoDeadline, nullptr);
  if (answer.ok()) answer->matches = {};
  return answer;
}

Compared Compare(const Recording& recording, const RecordPosition& position, const Side& before,
                 const Side& after) {
  Compared compared;
  Result<RecordedQuery> recorded = recording.Read(position);
  if (!recorded.ok()) {
    compared.status = recorded.status();
    return compared;
  }
  compared.recorded = *std::move(recorded);
  const Query query = compared.recorded.ToRepeat();
  compared.before = RunOn(before, query);
  compared.after = RunOn(after, query);
  compared.recorded.query.views.clear();  // thousands of queries are more than the memory holds
  return compared;
}

}  // namespace

std::string Side::Name() const {
  const std::string name = "version " + std::to_string(map->info.key.version);
  return strategy ? name + " with " + std::string(StrategyName(*strategy)) : name;
}

Result<ChangeReport> Rerun(const Recording& recording, const std::vector<RecordPosition>& positions,
                           const Side& before, const Side& after,
                           const std::function<void(int done)>& progress) {
  std::vector<Compared> compared(positions.size());
  ParallelFor(
      static_cast<int>(positions.size()),
      [&](int i) { compared[i] = Compare(recording, positions[i], before, after); }, progress);
  ChangeReport report(before.Name(), after.Name());
  for (const Compared& one : compared) {
    MAPLOC_RETURN_IF_ERROR(one.status);
    report.Add(one.recorded, one.before, one.after);
  }
  return report;
}

}  // namespace maploc
