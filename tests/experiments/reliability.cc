// Is the confidence calibrated? Of the answers given 0.9, nine in ten should be right.
#include <algorithm>
#include <array>
#include <iterator>
#include <string>

#include "tests/experiments/chance_matches.h"
#include "tests/experiments/experiment.h"
#include "tests/experiments/judged_answer.h"
#include "tests/experiments/progress.h"
#include "tests/experiments/protocol.h"
#include "tests/experiments/trials.h"

namespace maploc::experiments {
namespace {

// Bins [edge, next edge); the last one holds 1 itself.
constexpr std::array kEdges = {0.0, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 0.999};
constexpr double kGravityNoiseDeg = 0.5;

// Which share of answers is right depends on how many queries have any true match. Results are
// given for two populations; the product is calibrated for the first
// (server/trust/MEASUREMENTS.md).
struct Population {
  std::string name;
  int one_in = 1;  // one in so many queries has any true match
};
const Population kPopulations[] = {{"1 in 30 holds truth", 30}, {"all hold truth", 1}};

// Two thirds facades of repeats, of each kind half with lines.
testing::SyntheticProblem MakeWithoutTruth(Random& random) {
  testing::SyntheticProblem made;
  const double line_share = random.Below(2) == 0 ? 0.0 : kLineShare;
  made.problem = random.Below(3) == 0 ? MakeRandomMatches(line_share, random)
                                      : MakeFacade(line_share, 0.0, random);
  made.camera_from_map.translation = {0, 0, 1e9};  // no answer is right
  return made;
}

// Few inliers among many wrong matches, so that every confidence occurs.
testing::SyntheticProblem MakeWithTruth(Random& random) {
  testing::SyntheticOptions options;
  options.scene = random.Below(2) == 0 ? testing::Scene::kCube : testing::Scene::kCorridor;
  options.outliers = random.Below(2) == 0 ? testing::Outliers::kRandomPixels
                                          : testing::Outliers::kWrongAssociations;
  options.point_inliers = 3 + static_cast<int>(random.Below(15));
  options.point_outliers = 10 + static_cast<int>(random.Below(290));
  if (random.Below(2) == 0) {
    options.line_inliers = static_cast<int>(random.Below(8));
    options.line_outliers = static_cast<int>(random.Below(60));
  }
  options.gravity_noise_rad = options.gravity_sigma_rad = kGravityNoiseDeg * kDegree;
  return testing::MakeSyntheticProblem(options, random);
}

struct Bin {
  int answers = 0;
  int right = 0;
  double confidence = 0.0;  // sum
};
using Bins = std::array<Bin, kEdges.size()>;

void Add(const JudgedAnswer& answer, const Rigid3& truth, Bins& bins) {
  const double confidence = answer.verdict.confidence;
  const auto above = std::ranges::upper_bound(kEdges, confidence);
  Bin& bin = bins[static_cast<std::size_t>(above - kEdges.begin()) - 1];
  const testing::PoseError error = testing::ComparePoses(answer.camera_from_map, truth);
  ++bin.answers;
  bin.confidence += confidence;
  bin.right += error.rotation_rad < 5.0 * kDegree && error.position < 0.5 ? 1 : 0;
}

Bins RunMethod(Strategy strategy, const Population& population, const RunOptions& options,
               Progress& progress) {
  Bins bins;
  for (int trial = 0; trial < options.trials; ++trial) {
    Random random = TrialRandom(options.seed, "reliability " + population.name, trial);
    const std::uint64_t seed = random.Next();
    const testing::SyntheticProblem made =
        trial % population.one_in == 0 ? MakeWithTruth(random) : MakeWithoutTruth(random);
    const JudgedAnswer answer = AnswerAsProduct(made.problem, strategy, seed);
    if (answer.verdict.confidence > 0) Add(answer, made.camera_from_map, bins);
    progress.Step();
  }
  return bins;
}

void AddRows(const Bins& bins, const std::string& method, const Population& population, int trials,
             Rows& rows) {
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (bins[i].answers == 0) continue;
    rows.push_back({{"experiment", "reliability"},
                    {"method", method},
                    {"population", population.name},
                    {"confidence_from", kEdges[i]},
                    {"confidence_to", i + 1 < kEdges.size() ? kEdges[i + 1] : 1.0},
                    {"trials", trials},
                    {"answers", bins[i].answers},
                    {"mean_confidence", bins[i].confidence / bins[i].answers},
                    {"success_rate", static_cast<double>(bins[i].right) / bins[i].answers}});
  }
}

Result<Rows> RunReliability(const RunOptions& options) {
  Rows rows;
  Progress progress("reliability", options.trials * static_cast<int>(options.methods.size()) *
                                       static_cast<int>(std::size(kPopulations)));
  for (const Population& population : kPopulations) {
    MAPLOC_ASSIGN_OR_RETURN(const bool asked,
                            Matches({{"population", population.name}}, options.only));
    if (!asked) continue;
    for (const std::string& method : options.methods) {
      MAPLOC_ASSIGN_OR_RETURN(const Strategy strategy, ProductStrategy(method));
      AddRows(RunMethod(strategy, population, options, progress), method, population,
              options.trials, rows);
    }
  }
  return rows;
}

}  // namespace

Experiment ReliabilityExperiment() {
  Experiment experiment;
  experiment.name = "reliability";
  experiment.description =
      "Answers by their confidence, and the share of them within 5 degrees and 0.5 m";
  experiment.example = "maploc-experiments reliability --trials 10000";
  experiment.default_methods = {"mixed-auto"};
  experiment.default_trials = 5000;
  experiment.views = {{.name = "reliability",
                       .title = "Reliability: share of right answers by confidence",
                       .panel_keys = {"population"},
                       .x_key = "mean_confidence",
                       .y_key = "success_rate",
                       .x_label = "confidence",
                       .y_label = "right within 5 degrees and 0.5 m",
                       .y_is_share = true,
                       .is_table = false}};
  experiment.run = RunReliability;
  return experiment;
}

}  // namespace maploc::experiments
