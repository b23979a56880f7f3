#include "client/cli/season_board.h"

#include <cstdio>
#include <ostream>

#include "client/cli/output.h"

namespace maploc {
namespace {

std::string Mark(const ReplayEntry& entry) {
  if (!entry.error) return Colour(Ink::kGrey, "o");
  const PoseError& error = *entry.error;
  if (error.translation_m > kWrongTranslationM || error.rotation_deg > kWrongRotationDeg) {
    return Colour(Ink::kRed, "X");
  }
  const bool fine = error.translation_m <= kRecallThresholds[0].translation_m &&
                    error.rotation_deg <= kRecallThresholds[0].rotation_deg;
  return fine ? Colour(Ink::kGreen, "|") : Colour(Ink::kYellow, ":");
}

}  // namespace

SeasonBoard::SeasonBoard(std::ostream& out, bool live, std::vector<std::string> robots, int queries)
    : out_(out), live_(live), queries_(queries) {
  for (std::string& robot : robots) rows_.push_back({std::move(robot), {}, 0, 0, {}, {}, {}});
  if (live_) {
    for (const Row& row : rows_) out_ << Line(row) << "\n";
    out_ << std::flush;
  }
}

void SeasonBoard::Add(int robot, const ReplayEntry& entry) {
  const std::lock_guard lock(mutex_);
  Row& row = rows_[robot];
  row.marks += Mark(entry);
  ++row.answers;
  row.latencies_ms.push_back(entry.latency_ms);
  if (entry.error) {
    ++row.localized;
    row.translation_errors_m.push_back(entry.error->translation_m);
    row.rotation_errors_deg.push_back(entry.error->rotation_deg);
  }
  if (live_) {
    Redraw();
  } else if (row.answers == queries_) {
    out_ << Line(row) << "\n" << std::flush;
  }
}

void SeasonBoard::Redraw() {
  // All rows anew: the robots of a season answer in any order, and each fills its own row.
  out_ << "\033[" << rows_.size() << "A";
  for (const Row& row : rows_) out_ << "\r\033[K" << Line(row) << "\n";
  out_ << std::flush;
}

std::string SeasonBoard::Line(const Row& row) const {
  char head[48];
  std::snprintf(head, sizeof(head), "  %-8s ", row.robot.c_str());
  const std::string blanks(static_cast<std::size_t>(queries_ - row.answers), ' ');
  std::string line = head + row.marks + blanks + " ";
  if (row.answers == 0) return line;
  char tail[96];
  const double centimetres = 100.0 * Quantile(row.translation_errors_m, 0.5).value_or(0.0);
  std::snprintf(tail, sizeof(tail), "%2d/%d  %4.1f cm  %.2f deg  %3.0f ms", row.localized,
                row.answers, centimetres, Quantile(row.rotation_errors_deg, 0.5).value_or(0.0),
                Quantile(row.latencies_ms, 0.5).value_or(0.0));
  return line + tail;
}

}  // namespace maploc
