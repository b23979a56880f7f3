#include "tests/experiments/selection/run_selection.h"

#include "tests/experiments/selection/campus_set.h"
#include "tests/experiments/selection/recorded_folder.h"
#include "tests/experiments/selection/second_pass.h"

namespace maploc::selection {
namespace {

Result<SelectionSet> LoadSet(const SelectionFlags& flags) {
  if (flags.set == "campus") {
    return MakeCampusSet({.queries = flags.queries, .seed = flags.trials.seed});
  }
  RecordedFolderOptions options;
  options.folder = flags.set;
  options.gravity_in_source = flags.gravity_in_source;
  options.seed = flags.trials.seed;
  return LoadRecordedFolder(options);
}

// Where nobody says what stands there, the paper's rule says it from all sessions: structured is
// where lines are inliers at least as often as points.
void LabelByRatios(std::vector<SessionResult>& sessions, const SelectorOptions& selector) {
  std::map<SegmentId, Scene> scenes;
  for (const auto& [segment, choice] : ChooseForAll(sessions, selector)) {
    const auto points = choice.statistics.PointInlierRatio();
    const auto lines = choice.statistics.LineInlierRatio();
    scenes[segment] =
        lines && *lines >= points.value_or(0.0) ? Scene::kStructured : Scene::kUnstructured;
  }
  for (SessionResult& session : sessions) {
    for (QueryResult& query : session.queries) {
      const auto found = scenes.find(query.segment);
      if (!query.scene && found != scenes.end()) query.scene = found->second;
    }
  }
}

}  // namespace

Result<SelectionResult> RunSelection(const SelectionFlags& flags, const ProgressFn& progress) {
  MAPLOC_ASSIGN_OR_RETURN(const SelectionSet set, LoadSet(flags));
  SelectionResult result{flags, {}, {}};
  for (const SetSession& session : set.sessions) {
    SessionResult own{session.name, {}};
    MAPLOC_ASSIGN_OR_RETURN(own.queries, RunTrials(set, session, flags.trials, progress));
    result.sessions.push_back(std::move(own));
  }
  LabelByRatios(result.sessions, flags.selector);
  result.left_out = LeaveEachOut(result.sessions, flags.selector);
  for (std::size_t i = 0; i < result.sessions.size(); ++i) {
    RunSecondPass(set.sessions[i], result.left_out[i], flags.trials, result.sessions[i]);
  }
  return result;
}

}  // namespace maploc::selection
