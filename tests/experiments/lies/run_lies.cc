#include "tests/experiments/lies/run_lies.h"

#include <algorithm>
#include <cstdio>
#include <mutex>

#include "mapstore/importers/parallel.h"
#include "server/pipeline/localizer.h"
#include "tests/experiments/lies/recorded_sets.h"
#include "tests/experiments/lies/tally.h"
#include "tests/experiments/progress.h"
#include "tests/experiments/trials.h"

namespace maploc::lies {
namespace {

bool IsAsked(const Lie& lie, const LieOptions& options) {
  return options.families.empty() || std::ranges::count(options.families, lie.family) > 0;
}

// The same draw of a query is the same for every lie: subsets with and without lines are of the
// same keypoints.
Random DrawRandom(const LieOptions& options, const HonestQuery& honest, int draw) {
  return experiments::TrialRandom(options.seed, honest.name, draw);
}

void TellOff(const Lie& lie, const HonestQuery& honest, const Localization& answer,
             const Answered& compared) {
  const Evidence& e = answer.evidence;
  std::fprintf(stderr,
               "%s %s: %.3f (%.2f%%) %.2f deg %.1f sigmas, confidence %.4f, points %d/%d, lines "
               "%d/%d, gravity %.1f deg%s\n",
               lie.name.c_str(), honest.name.c_str(), compared.translation, 100 * compared.relative,
               compared.rotation_deg, compared.sigmas, e.confidence, e.points.inliers,
               e.points.matches, e.usable_lines.inliers + e.vertical_lines.inliers,
               e.usable_lines.matches + e.vertical_lines.matches,
               e.gravity_disagreement_rad * 57.2957795, e.gravity_rejected ? " rejected" : "");
}

// One query's lies are told one after the other; queries in parallel.
class LieRun {
 public:
  LieRun(const LoadedSet& set, const LieOptions& options, std::vector<Lie> lies)
      : set_(set), options_(options), lies_(std::move(lies)), tallies_(lies_.size()) {}

  Result<experiments::Rows> Run() {
    experiments::Progress progress("lies, " + set_.name, static_cast<int>(set_.queries.size()));
    ParallelFor(static_cast<int>(set_.queries.size()), [&](int i) {
      for (std::size_t k = 0; k < lies_.size(); ++k) TellAll(set_.queries[i], k);
      const std::lock_guard lock(mutex_);
      progress.Step();
    });
    MAPLOC_RETURN_IF_ERROR(failed_);
    experiments::Rows rows;
    for (std::size_t k = 0; k < lies_.size(); ++k) {
      if (tallies_[k].queries() > 0) rows.push_back(tallies_[k].ToRow(set_.name, lies_[k]));
    }
    return rows;
  }

 private:
  void TellAll(const HonestQuery& honest, std::size_t k) {
    for (int draw = 0; draw < (lies_[k].is_random ? options_.draws : 1); ++draw) {
      Random random = DrawRandom(options_, honest, draw);
      Result<Query> query = lies_[k].tell(honest, draw, random);
      if (!query.ok() && query.status().reason() == "DOES_NOT_APPLY") return;
      const Status status = query.ok() ? Ask(honest, *query, k) : query.status();
      const std::lock_guard lock(mutex_);
      if (!status.ok()) failed_ = status.WithContext(honest.name);
    }
  }

  Status Ask(const HonestQuery& honest, Query& query, std::size_t k) {
    query.refinement = options_.refinement;
    MAPLOC_ASSIGN_OR_RETURN(const Localization answer,
                            Localize(query, *set_.map, {}, kNoDeadline, nullptr));
    const Answered compared = Compare(answer, honest, set_.metric);
    const std::lock_guard lock(mutex_);
    tallies_[k].Add(answer, compared);
    if (options_.verbose && (compared.off || (compared.localized && compared.sigmas > 3.5))) {
      TellOff(lies_[k], honest, answer, compared);
    }
    return Status::Ok();
  }

  const LoadedSet& set_;
  const LieOptions& options_;
  const std::vector<Lie> lies_;
  std::mutex mutex_;
  std::vector<Tally> tallies_;
  Status failed_;
};

}  // namespace

Result<experiments::Rows> RunLies(const LieOptions& options) {
  std::vector<Lie> lies;
  for (Lie& lie : AllLies()) {
    if (IsAsked(lie, options)) lies.push_back(std::move(lie));
  }
  if (lies.empty()) return InvalidArgument("--families", "names no family of lies");
  experiments::Rows rows;
  for (const std::string& name : options.sets) {
    MAPLOC_ASSIGN_OR_RETURN(const LoadedSet set, LoadSet(name, options.data_folder, options.seed));
    MAPLOC_ASSIGN_OR_RETURN(const experiments::Rows some, LieRun(set, options, lies).Run());
    rows.insert(rows.end(), some.begin(), some.end());
  }
  return rows;
}

}  // namespace maploc::lies
