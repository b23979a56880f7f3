// Matches without any truth in them: how often does the product say LOCALIZED all the same?
#include <algorithm>
#include <functional>

#include "tests/experiments/chance_matches.h"
#include "tests/experiments/experiment.h"
#include "tests/experiments/judged_answer.h"
#include "tests/experiments/progress.h"
#include "tests/experiments/trials.h"

namespace maploc::experiments {
namespace {

constexpr int kIterations = 10000;  // no early stop: the more tries, the better chance fits
constexpr int kSteps = 100;         // of the progress, a kind and method

struct Kind {
  std::string name;
  std::function<PoseProblem(Random&)> make;
};

std::vector<Kind> Kinds() {
  return {
      {"random points", [](Random& random) { return MakeRandomMatches(0, random); }},
      {"random points and lines",
       [](Random& random) { return MakeRandomMatches(kLineShare, random); }},
      {"repeats, points", [](Random& random) { return MakeFacade(0, 0, random); }},
      {"repeats, points and lines",
       [](Random& random) { return MakeFacade(kLineShare, 0, random); }},
      {"moved signs", MakeSigns},
      // Reported apart: here a wrong pose does explain the picture.
      {"one shift for 20%", [](Random& random) { return MakeFacade(0, 0.2, random); }},
      {"one shift for 50%", [](Random& random) { return MakeFacade(0, 0.5, random); }},
  };
}

Row RunKind(const Kind& kind, const std::string& method, Strategy strategy,
            const RunOptions& options, Progress& progress) {
  int localized = 0;
  double largest = 0.0, iterations = 0.0;
  for (int trial = 0; trial < options.trials; ++trial) {
    Random random = TrialRandom(options.seed, "false-accepts " + kind.name, trial);
    const std::uint64_t seed = random.Next();
    const JudgedAnswer answer = AnswerAsProduct(kind.make(random), strategy, seed, kIterations);
    localized += answer.verdict.outcome == Outcome::kLocalized ? 1 : 0;
    iterations += answer.iterations;
    largest = std::max(largest, answer.verdict.confidence);
    if ((trial + 1) % std::max(1, options.trials / kSteps) == 0) progress.Step();
  }
  return {{"experiment", "false-accepts"}, {"method", method},
          {"matches", kind.name},          {"trials", options.trials},
          {"queries", options.trials},     {"localized", localized},
          {"largest_confidence", largest}, {"mean_iterations", iterations / options.trials}};
}

Result<Rows> RunFalseAccepts(const RunOptions& options) {
  Rows rows;
  std::vector<Kind> kinds;
  for (const Kind& kind : Kinds()) {
    MAPLOC_ASSIGN_OR_RETURN(const bool asked, Matches({{"matches", kind.name}}, options.only));
    if (asked) kinds.push_back(kind);
  }
  if (kinds.empty()) return InvalidArgument("--only", "no kind of matches has these values");
  std::vector<Strategy> strategies;
  for (const std::string& method : options.methods) {
    MAPLOC_ASSIGN_OR_RETURN(strategies.emplace_back(), ProductStrategy(method));
  }
  Progress progress("false-accepts", static_cast<int>(kinds.size() * strategies.size()) *
                                         std::min(kSteps, options.trials));
  for (const Kind& kind : kinds) {
    for (std::size_t i = 0; i < strategies.size(); ++i) {
      rows.push_back(RunKind(kind, options.methods[i], strategies[i], options, progress));
    }
  }
  return rows;
}

}  // namespace

Experiment FalseAcceptsExperiment() {
  Experiment experiment;
  experiment.name = "false-accepts";
  experiment.description =
      "Queries whose matches are all wrong, a kind of wrongness a row: how many are LOCALIZED";
  experiment.example = "maploc-experiments false-accepts --trials 25000";
  experiment.default_methods = {"mixed-auto"};
  experiment.default_trials = 1000;
  experiment.run = RunFalseAccepts;
  return experiment;
}

}  // namespace maploc::experiments
