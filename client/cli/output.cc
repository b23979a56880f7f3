#include "client/cli/output.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include <unistd.h>

namespace maploc {
namespace {

constexpr int kBarWidth = 24;

// Characters shown: colour codes (ESC ... m) and the tails of UTF-8 sequences take no width.
std::size_t Width(const std::string& text) {
  std::size_t width = 0;
  bool in_code = false;
  for (const char c : text) {
    if (c == '\033') in_code = true;
    if (!in_code && (static_cast<unsigned char>(c) & 0xC0) != 0x80) ++width;
    if (in_code && c == 'm') in_code = false;
  }
  return width;
}

const char* Code(Ink ink) {
  switch (ink) {
    case Ink::kGreen:
      return "32";
    case Ink::kYellow:
      return "33";
    case Ink::kRed:
      return "31";
    case Ink::kBlue:
      return "34";
    case Ink::kGrey:
      return "90";
    case Ink::kBold:
      return "1";
  }
  return "0";
}

}  // namespace

void PrintJson(const nlohmann::ordered_json& document) { std::cout << document.dump(2) << "\n"; }

nlohmann::ordered_json JsonOrNull(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

std::string FormatNumber(const std::optional<double>& value, int digits) {
  if (!value) return "-";
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, *value);
  return text;
}

Table::Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }

void Table::AddRow(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

void Table::Print(std::ostream& out) const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], Width(row[i]));
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    for (std::size_t i = 0; i < rows_[r].size(); ++i) {
      out << (i == 0 ? "" : "  ") << rows_[r][i];
      if (i + 1 < rows_[r].size()) out << std::string(widths[i] - Width(rows_[r][i]), ' ');
    }
    out << "\n";
    if (r > 0) continue;
    for (std::size_t i = 0; i < widths.size(); ++i) {
      out << (i == 0 ? "" : "  ") << std::string(widths[i], '-');
    }
    out << "\n";
  }
}

std::string Colour(Ink ink, const std::string& text) {
  static const bool enabled = isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  return enabled ? "\033[" + std::string(Code(ink)) + "m" + text + "\033[0m" : text;
}

Progress::Progress(std::string what, int total)
    : what_(std::move(what)), total_(total), visible_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (visible_) std::cerr << "\r\033[K" << std::flush;
}

void Progress::Advance(const std::string& note) {
  ++done_;
  if (!visible_) return;
  const int filled = total_ > 0 ? std::min(kBarWidth, kBarWidth * done_ / total_) : 0;
  std::cerr << "\r\033[K" << what_ << " [" << std::string(filled, '#')
            << std::string(kBarWidth - filled, '.') << "] " << done_ << "/" << total_ << " " << note
            << std::flush;
}

}  // namespace maploc
