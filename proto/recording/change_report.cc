#include "proto/recording/change_report.h"

#include <algorithm>
#include <ostream>
#include <utility>

#include "mapstore/base/angles.h"
#include "mapstore/base/median.h"
#include "mapstore/base/table.h"
#include "mapstore/base/text.h"

namespace maploc {
namespace {

using Json = nlohmann::ordered_json;

// Below it, whether better or worse prevails is no accident.
constexpr double kSurely = 0.05;

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

std::string OrDash(const std::optional<double>& value, int decimals) {
  return value ? FixedText(*value, decimals) : "-";
}

std::optional<double> Degrees(const std::optional<double>& radians) {
  if (!radians) return std::nullopt;
  return kDegPerRad * *radians;
}

}  // namespace

ChangeReport::ChangeReport(std::string before, std::string after)
    : before_(std::move(before)), after_(std::move(after)) {}

ChangeReport::Told ChangeReport::Tell(const Result<Localization>& answer) {
  Told told;
  told.outcome = OutcomeText(answer);
  told.sigma = PositionSigma(answer);
  if (!answer.ok()) return told;
  const Evidence& evidence = answer->evidence;
  told.inliers =
      evidence.points.inliers + evidence.usable_lines.inliers + evidence.vertical_lines.inliers;
  return told;
}

Change ChangeReport::Add(const RecordedQuery& recorded, const Result<Localization>& before,
                         const Result<Localization>& after) {
  rows_.push_back({recorded.answered_unix_ns, recorded.robot, recorded.query.request_id,
                   Tell(before), Tell(after), CompareAnswers(before, after)});
  return rows_.back().change.change;
}

std::optional<double> ChangeReport::Row::SigmaRatio() const {
  if (!before.sigma || !after.sigma || *before.sigma <= 0.0) return std::nullopt;
  return *after.sigma / *before.sigma;
}

ChangeReport::Sums ChangeReport::Sum() const {
  Sums sums;
  std::vector<double> ratios;
  for (const Row& row : rows_) {
    sums.better += row.change.change == Change::kBetter ? 1 : 0;
    sums.worse += row.change.change == Change::kWorse ? 1 : 0;
    sums.moved += row.change.change == Change::kMoved ? 1 : 0;
    sums.same += row.change.change == Change::kSame ? 1 : 0;
    sums.localized_before += row.before.sigma ? 1 : 0;
    sums.localized_after += row.after.sigma ? 1 : 0;
    if (const auto ratio = row.SigmaRatio()) ratios.push_back(*ratio);
  }
  if (!ratios.empty()) sums.sigma_ratio = Median(ratios);
  return sums;
}

std::string ChangeReport::Verdict(const Sums& sums) {
  if (ChanceOf(sums.better, sums.worse) > kSurely) return "no difference";
  return sums.worse > sums.better ? "worse" : "better";
}

Json ChangeReport::RowJson(const Row& row) {
  return {{"answered_unix_ns", row.answered_unix_ns},
          {"robot", row.robot},
          {"request_id", row.request_id},
          {"change", ChangeName(row.change.change)},
          {"outcome_before", row.before.outcome},
          {"outcome_after", row.after.outcome},
          {"translation", OrNull(row.change.translation)},
          {"rotation_deg", OrNull(Degrees(row.change.rotation_rad))},
          {"position_sigma_before", OrNull(row.before.sigma)},
          {"position_sigma_after", OrNull(row.after.sigma)},
          {"inliers_before", row.before.inliers},
          {"inliers_after", row.after.inliers}};
}

Json ChangeReport::Json() const {
  const Sums sums = Sum();
  auto queries = Json::array();
  for (const Row& row : rows_) queries.push_back(RowJson(row));
  return {{"before", before_},
          {"after", after_},
          {"queries", rows_.size()},
          {"better", sums.better},
          {"worse", sums.worse},
          {"moved", sums.moved},
          {"same", sums.same},
          {"localized_before", sums.localized_before},
          {"localized_after", sums.localized_after},
          {"median_sigma_ratio", OrNull(sums.sigma_ratio)},
          {"verdict", Verdict(sums)},
          {"chance", ChanceOf(sums.better, sums.worse)},
          {"per_query", queries}};
}

std::string ChangeReport::Conclusion(const Sums& sums) const {
  const std::string verdict = Verdict(sums);
  std::string text = after_ + " against " + before_ + ": " + verdict;
  if (verdict != "no difference") {
    text += " (by chance with a probability of " + FixedText(ChanceOf(sums.better, sums.worse), 4) +
            ")";
  }
  if (sums.moved == 0) return text + ".";
  return text + ". Of " + std::to_string(sums.moved) +
         " moved queries one of both poses is wrong, or the map's frame is another one.";
}

void ChangeReport::Print(std::ostream& out) const {
  Table table({"answered", "robot", "change", before_, after_, "moved by", "degrees",
               "sigma before", "sigma after", "inliers"});
  bool any = false;
  for (const Row& row : rows_) {
    if (row.change.change == Change::kSame && row.before.outcome == row.after.outcome) continue;
    any = true;
    table.AddRow({UtcText(row.answered_unix_ns), row.robot,
                  std::string(ChangeName(row.change.change)), row.before.outcome, row.after.outcome,
                  OrDash(row.change.translation, 3), OrDash(Degrees(row.change.rotation_rad), 3),
                  OrDash(row.before.sigma, 4), OrDash(row.after.sigma, 4),
                  std::to_string(row.before.inliers) + " -> " + std::to_string(row.after.inliers)});
  }
  if (any) table.Print(out);
  const Sums sums = Sum();
  out << rows_.size() << " queries: " << sums.better << " better, " << sums.worse << " worse, "
      << sums.moved << " moved, " << sums.same << " the same; localized " << sums.localized_before
      << " before, " << sums.localized_after << " after.\n"
      << Conclusion(sums) << "\n";
}

}  // namespace maploc
