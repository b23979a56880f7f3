#include "client/cli/output.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include <unistd.h>

namespace maploc {
namespace {

constexpr int kBarWidth = 24;

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

void PrintJson(const nlohmann::ordered_json& document) {
  // A name that is not UTF-8 must not keep the rest from being read.
  std::cout << document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
            << "\n";
}

nlohmann::ordered_json JsonOrNull(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

std::string FormatNumber(const std::optional<double>& value, int digits) {
  if (!value) return "-";
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, *value);
  return text;
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
