#include "tests/experiments/selection/tables.h"

#include <cstdio>
#include <ostream>

#include "mapstore/base/table.h"
#include "mapstore/base/text.h"
#include "mapstore/tools/output.h"
#include "tests/experiments/selection/groups.h"

namespace maploc::selection {
namespace {

std::string FourPercent(const std::vector<ScoredQuery>& queries, int column) {
  if (queries.empty()) return "-";
  const Score score = ScoreOf(queries, column);
  char text[64];
  std::snprintf(text, sizeof(text), "%.1f/%.1f/%.1f/%.1f", 100.0 * score.recall[0],
                100.0 * score.recall[1], 100.0 * score.recall[2], 100.0 * score.recall[3]);
  return text;
}

std::string Signed(double value) {
  char text[16];
  std::snprintf(text, sizeof(text), "%+.4f", value);
  return text;
}

// Methods down, groups across, as in the paper.
void PrintRecall(const SelectionResult& result, const std::string& title,
                 const std::vector<NamedGroup>& groups, std::ostream& out) {
  out << "\n" << title << ": % within .25/.5/1/5 m and 2/5/8/10 degrees\n";
  std::vector<std::string> header = {"method"};
  for (const NamedGroup& group : groups) header.push_back(group.name);
  Table table(header);
  for (const int column : ColumnsOf(result)) {
    std::vector<std::string> cells = {std::string(ColumnName(column))};
    for (const NamedGroup& group : groups) cells.push_back(FourPercent(group.queries, column));
    table.AddRow(cells);
  }
  table.Print(out);
}

void PrintByScene(const SelectionResult& result, std::ostream& out) {
  for (const auto& [scene, name] : {std::pair{Scene::kUnstructured, "unstructured"},
                                    std::pair{Scene::kStructured, "structured"}}) {
    std::vector<NamedGroup> groups;
    for (std::size_t i = 0; i < result.sessions.size(); ++i) {
      groups.push_back({result.sessions[i].name, QueriesOf(result, i, scene)});
    }
    groups.push_back({"whole", WholeOf(result, scene)});
    PrintRecall(result, std::string("Table II, ") + name + " places", groups, out);
  }
}

void PrintAuc(const SelectionResult& result, std::ostream& out) {
  out << "\nTable III: area under the curve, 100 iterations, no fallback\n";
  std::vector<std::string> header = {"left out"};
  for (const int column : ColumnsOf(result)) header.emplace_back(ColumnName(column));
  header.insert(header.end(), {"best single", "selection less it", "95% of queries drawn anew"});
  Table table(header);
  for (const NamedGroup& group : SessionsAndWhole(result)) {
    std::vector<std::string> cells = {group.name};
    for (const int column : ColumnsOf(result)) {
      cells.push_back(FixedText(ScoreOf(group.queries, column).auc, 4));
    }
    const int best = BestSingle(group.queries);
    const Interval interval = BootstrapSelection(group.queries, best, result.flags.trials.seed);
    cells.emplace_back(ColumnName(best));
    cells.push_back(
        Signed(ScoreOf(group.queries, kSelection).auc - ScoreOf(group.queries, best).auc));
    cells.push_back(Signed(interval.low) + " to " + Signed(interval.high));
    table.AddRow(cells);
  }
  table.Print(out);
}

void PrintLong(const SelectionResult& result, std::ostream& out) {
  out << "\nSecond pass, to a confidence of 0.999 and at most 100,000 iterations: mean iterations; "
         "mean ms of a query (processor time, search and refinement); % within 0.25 m and 2 "
         "degrees\n";
  std::vector<std::string> header = {"left out"};
  for (const int column : LongColumnsOf(result)) header.emplace_back(ColumnName(column));
  Table table(header);
  for (const NamedGroup& group : SessionsAndWhole(result)) {
    std::vector<std::string> cells = {group.name};
    for (const int column : LongColumnsOf(result)) {
      const Score score = ScoreOf(group.queries, column);
      cells.push_back(FixedText(score.mean_long_iterations, 0) + "; " +
                      FixedText(score.mean_long_ms, 3) + "; " +
                      FixedText(100.0 * score.long_recall, 1));
    }
    table.AddRow(cells);
  }
  table.Print(out);
}

// "1p1l .31 .47": what is drawn, and the inlier ratios of points and lines that the others saw.
std::string ChoiceText(const LeftOut& left_out, SegmentId segment) {
  const auto found = left_out.segments.find(segment);
  if (found == left_out.segments.end()) return "-";
  const SegmentChoice& choice = found->second;
  return std::string(StrategyName(choice.decision.strategy)) + " " +
         FormatRatio(choice.statistics.PointInlierRatio()) + " " +
         FormatRatio(choice.statistics.LineInlierRatio());
}

void PrintSegments(const SelectionResult& result, std::ostream& out) {
  out << "\nWhat the others teach of each segment when one is left out: strategy, inlier ratio of "
         "points, of lines\n";
  std::vector<std::string> header = {"segment"};
  for (const LeftOut& left_out : result.left_out) header.push_back(left_out.name);
  Table table(header);
  for (const auto& [segment, all] : ChooseForAll(result.sessions, result.flags.selector)) {
    std::vector<std::string> cells = {std::to_string(segment)};
    for (const LeftOut& left_out : result.left_out) cells.push_back(ChoiceText(left_out, segment));
    table.AddRow(cells);
  }
  table.Print(out);
}

}  // namespace

void PrintTables(const SelectionResult& result, std::ostream& out) {
  PrintRecall(result, "Table I, whole sessions", SessionsAndWhole(result), out);
  PrintByScene(result, out);
  PrintAuc(result, out);
  PrintLong(result, out);
  PrintSegments(result, out);
}

}  // namespace maploc::selection
