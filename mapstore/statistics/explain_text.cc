#include <cmath>
#include <sstream>

#include "mapstore/base/text.h"
#include "mapstore/statistics/explain.h"

namespace maploc {
namespace {

std::string Name(Strategy strategy) { return std::string(StrategyName(strategy)); }

// An iteration costs about 1, which needs its decimals; times are far larger.
std::string NumberText(double value) {
  if (!std::isfinite(value)) return "never";
  return FixedText(value, value < 10.0 ? 2 : 1);
}

void WriteRate(std::ostream& out, const std::string& name, const ExplainedRate& rate,
               const std::string& what) {
  out << "  " << name << " = " << FixedText(rate.posterior.Mean(), 3)
      << " (95%: " << FixedText(rate.credible_95.low, 3) << " to "
      << FixedText(rate.credible_95.high, 3) << "): " << FixedText(rate.good, 1) << " of "
      << FixedText(rate.total, 1) << " " << what << ", worth " << FixedText(rate.independent, 1)
      << " independent ones; Beta(" << FixedText(rate.posterior.a, 1) << ", "
      << FixedText(rate.posterior.b, 1) << ")\n";
}

void WriteStrategy(std::ostream& out, Strategy strategy, const StrategyOutlook& outlook,
                   const SelectorOptions& options) {
  const double cost = CostOf(strategy, options);
  out << "  " << Name(strategy) << ": a draw is all inliers with "
      << FixedText(outlook.draw_probability, 5) << ", an iteration succeeds with "
      << FixedText(outlook.iteration_probability, 5) << ", a query of " << options.max_iterations
      << " with " << FixedText(outlook.query_probability, 4) << "; "
      << NumberText(outlook.expected_iterations) << " iterations x " << NumberText(cost) << " = "
      << NumberText(cost * outlook.expected_iterations) << ", for one success "
      << NumberText(outlook.expected_time) << "\n";
}

void WriteChoice(std::ostream& out, const Explanation& e) {
  out << "Choice by "
      << (e.options.criterion == StrategyCriterion::kPaper
              ? "the paper's rule (gamma >= lambda: 1p1l, else 2p)"
              : "the least expected time")
      << ": " << Name(e.best);
  if (!e.has_evidence) {
    // The share is kMinLocalizedShare of selector.cc.
    out << "; used only from " << e.options.min_localized_queries
        << " weighted localized queries on (now " << FixedText(e.statistics.weighted_localized, 1)
        << "), and if one query in ten is localized";
  } else if (e.gain_of_best > 0.0) {
    out << ", " << FixedText(100.0 * e.gain_of_best, 1)
        << "% faster than the one kept; a change requires "
        << FixedText(100.0 * e.options.hysteresis, 0) << "%";
  }
  out << "\n";
}

void WriteChanges(std::ostream& out, const Explanation& e) {
  for (const ChangePoint& change : e.changes) {
    out << "Since " << UtcText(change.since_unix_ns) << " (session " << change.since << ", "
        << change.sessions << " sessions) " << ChangeKindName(change.kind) << " "
        << (change.after < change.before ? "fell" : "rose") << " from "
        << FixedText(change.before, 3) << " to " << FixedText(change.after, 3) << " ("
        << FixedText(std::abs(change.deviation), 1) << " standard deviations)\n";
  }
}

void WriteSwitches(std::ostream& out, const Explanation& e) {
  for (const StrategySwitch& change : e.switches) {
    out << UtcText(change.session_start_unix_ns) << " session " << change.session << ": "
        << Name(change.before) << " -> " << Name(change.after.strategy) << ". "
        << change.after.reason << "\n";
  }
}

}  // namespace

std::string ExplanationText(const Explanation& e) {
  std::ostringstream out;
  out << "Uses " << Name(e.decision.strategy) << " (" << StrategySourceName(e.decision.source)
      << "): " << e.decision.reason << "\n\n"
      << e.statistics.queries << " queries, " << e.statistics.localized << " localized, in "
      << e.statistics.sessions << " sessions; by weight "
      << FixedText(e.statistics.weighted_queries, 1) << " and "
      << FixedText(e.statistics.weighted_localized, 1) << "\n";
  WriteRate(out, "success", e.success, "queries");
  WriteRate(out, "lambda", e.points, "point matches");
  WriteRate(out, "gamma", e.usable_lines, "usable line matches");
  WriteRate(out, "gamma_v", e.vertical_lines, "vertical line matches");
  const MatchCounts& matches = e.prediction.matches;
  out << "  p = " << FixedText(matches.points, 1) << ", l = " << FixedText(matches.usable_lines, 1)
      << ", lv = " << FixedText(matches.vertical_lines, 1)
      << " matches a query; vertical lines are drawn by "
      << (DrawsVerticalLines(Strategy::k1P1L, matches)    ? "1p1l and mixed"
          : DrawsVerticalLines(Strategy::kMixed, matches) ? "mixed alone"
                                                          : "none")
      << "\n\n";
  for (const Strategy strategy : e.decision.ranking) {
    WriteStrategy(out, strategy, e.prediction.Of(strategy), e.options);
  }
  WriteChoice(out, e);
  WriteChanges(out, e);
  WriteSwitches(out, e);
  return out.str();
}

}  // namespace maploc
