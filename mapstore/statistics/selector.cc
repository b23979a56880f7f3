#include "mapstore/statistics/selector.h"

#include <algorithm>
#include <cmath>

#include "mapstore/base/text.h"
#include "mapstore/statistics/criterion.h"

namespace maploc {
namespace {

// Where fewer than one query in ten is localized, the ratios of those say too little about the rest
// (and about a season that began with the failures).
constexpr double kMinLocalizedShare = 0.1;

// "1p1l 66.1, mixed 190.2, 2p never"
std::string TimesOf(const std::array<Strategy, 3>& ranking, const StrategyPrediction& prediction) {
  std::string text;
  for (const Strategy strategy : ranking) {
    const double time = prediction.Of(strategy).expected_time;
    if (!text.empty()) text += ", ";
    text += StrategyName(strategy);
    text += " " + (std::isfinite(time) ? FixedText(time, 1) : "never");
  }
  return text;
}

std::string MatchesText(const StrategyPrediction& prediction) {
  const InlierRates means = prediction.rates.Means();
  std::string text = "points " + FixedText(prediction.matches.points, 1) + " a query at " +
                     FixedText(means.points, 3) + ", usable lines " +
                     FixedText(prediction.matches.usable_lines, 1) + " at " +
                     FixedText(means.usable_lines, 3);
  if (DrawsVerticalLines(Strategy::kMixed, prediction.matches)) {
    text += ", vertical lines " + FixedText(prediction.matches.vertical_lines, 1) + " at " +
            FixedText(means.vertical_lines, 3);
  }
  return text;
}

// What the criterion alone would have said, where hysteresis overruled it.
std::string HeldBackText(Strategy current, const StrategyPrediction& prediction,
                         const SelectorOptions& options) {
  const Strategy best = RankStrategies(prediction, options).front();
  if (best == current) return "";
  return std::string("; ") + std::string(StrategyName(best)) + " is not better by the " +
         FixedText(100.0 * options.hysteresis, 0) + "% that a change requires";
}

std::string ReasonText(Strategy before, Strategy current, const StrategyPrediction& prediction,
                       const SegmentStatistics& statistics, const SelectorOptions& options) {
  std::string text(StrategyName(current));
  if (before != current) text += " instead of " + std::string(StrategyName(before));
  text += options.criterion == StrategyCriterion::kPaper ? " by the paper's rule" : "";
  text += ": expected time to success " + TimesOf(RankStrategies(prediction, options), prediction) +
          HeldBackText(current, prediction, options) + " (" + MatchesText(prediction) + "; " +
          FixedText(statistics.weighted_localized, 1) + " localized queries by weight, " +
          std::to_string(statistics.sessions) + " sessions)";
  return text;
}

StrategyDecision WithoutEvidence(const SegmentStatistics& statistics,
                                 const SelectorOptions& options) {
  return {Strategy::kMixed, StrategySource::kDefault,
          "mixed until there is evidence: " + FixedText(statistics.weighted_localized, 1) + " of " +
              std::to_string(options.min_localized_queries) +
              " localized queries, weighted by age, and one in ten of " +
              FixedText(statistics.weighted_queries, 1) + " queries",
          0.0, kSelectableStrategies};
}

}  // namespace

std::array<Strategy, 3> RankAfter(Strategy first, std::array<Strategy, 3> ranking) {
  const auto found = std::find(ranking.begin(), ranking.end(), first);
  std::rotate(ranking.begin(), found, found + 1);
  return ranking;
}

SelectorFold::SelectorFold(const SelectorOptions& options, const SelectorState& state)
    : options_(options),
      statistics_(options.statistics, state.sums),
      prediction_(PredictStrategies(statistics_.Value(), options)),
      previous_(state.previous),
      current_(state.current) {}

bool SelectorFold::HasEvidence() const {
  const SegmentStatistics s = statistics_.Value();
  return s.localized > 0 &&
         s.weighted_localized >= static_cast<double>(options_.min_localized_queries) &&
         s.weighted_localized >= kMinLocalizedShare * s.weighted_queries;
}

void SelectorFold::Add(const SegmentSessionRow& row) {
  statistics_.Add(row);
  prediction_ = PredictStrategies(statistics_.Value(), options_);
  previous_ = current_;
  current_ = HasEvidence() ? ChooseStrategy(current_, prediction_, options_) : Strategy::kMixed;
}

StrategyDecision SelectorFold::Decision() const {
  const SegmentStatistics statistics = statistics_.Value();
  if (!HasEvidence()) return WithoutEvidence(statistics, options_);
  return {current_, StrategySource::kLearned,
          ReasonText(previous_, current_, prediction_, statistics, options_),
          prediction_.Of(current_).iteration_probability,
          RankAfter(current_, RankStrategies(prediction_, options_))};
}

StrategyDecision SelectStrategy(std::span<const SegmentSessionRow> rows,
                                const SelectorOptions& options) {
  SelectorFold fold(options);
  for (const SegmentSessionRow& row : rows) fold.Add(row);
  return fold.Decision();
}

std::vector<StrategySwitch> ListSwitches(std::span<const SegmentSessionRow> rows,
                                         const SelectorOptions& options) {
  std::vector<StrategySwitch> switches;
  SelectorFold fold(options);
  for (const SegmentSessionRow& row : rows) {
    const Strategy before = fold.current();
    fold.Add(row);
    if (fold.current() == before) continue;
    switches.push_back({row.session, row.session_start_unix_ns, before, fold.Decision()});
  }
  return switches;
}

}  // namespace maploc
