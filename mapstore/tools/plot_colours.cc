#include "mapstore/tools/plot_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "mapstore/base/text.h"

namespace maploc {
namespace {

constexpr std::string_view kNoEvidence = "#b0b0b0";
constexpr std::string_view kUnchanged = "#4d4d4d";

using Rgb = std::array<double, 3>;

// Told apart also by those who confuse red and green (ColorBrewer's RdYlBu).
constexpr Rgb kWorst = {165, 0, 38};
constexpr Rgb kMiddle = {253, 174, 97};
constexpr Rgb kBest = {49, 54, 149};

std::string Hex(const Rgb& rgb) {
  std::array<char, 8> text;
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", static_cast<int>(std::lround(rgb[0])),
                static_cast<int>(std::lround(rgb[1])), static_cast<int>(std::lround(rgb[2])));
  return text.data();
}

// `share` in [0, 1], worst to best.
std::string Gradient(double share) {
  const bool low = share < 0.5;
  const Rgb& from = low ? kWorst : kMiddle;
  const Rgb& to = low ? kMiddle : kBest;
  const double t = std::clamp(low ? 2.0 * share : 2.0 * share - 1.0, 0.0, 1.0);
  Rgb mixed;
  for (std::size_t i = 0; i < 3; ++i) mixed[i] = from[i] + t * (to[i] - from[i]);
  return Hex(mixed);
}

// ColorBrewer's Dark2, told apart by the colour-blind too.
std::string OfStrategy(Strategy strategy) {
  switch (strategy) {
    case Strategy::k1P1L:
      return "#d95f02";
    case Strategy::k2P:
      return "#1b9e77";
    default:
      return "#7570b3";
  }
}

std::string OfInlierRatio(const SegmentStatistics& statistics) {
  const auto points = statistics.PointInlierRatio();
  const auto ratio = points ? points : statistics.LineInlierRatio();
  return ratio ? Gradient(*ratio) : std::string(kNoEvidence);
}

// What is left of what there was: 0 all gone, 1 the same, 2 twice as much or more.
double LeftOf(const ChangePoint& change) {
  // From nothing, any rise is the largest.
  if (change.before <= 0.0) return 2.0;
  return std::min(change.after / change.before, 2.0);
}

std::string OfChange(const SegmentSummary& segment, const SegmentChanges& changes) {
  if (segment.statistics.queries == 0) return std::string(kNoEvidence);
  if (changes.changes.empty()) return std::string(kUnchanged);
  double left = LeftOf(changes.changes.front());
  for (const ChangePoint& change : changes.changes) left = std::min(left, LeftOf(change));
  return Gradient(0.5 * left);
}

}  // namespace

std::string ColourOf(PlotColour colour, const SegmentSummary& segment,
                     const SegmentChanges& changes) {
  switch (colour) {
    case PlotColour::kStrategy:
      return OfStrategy(segment.decision.strategy);
    case PlotColour::kInlierRatio:
      return OfInlierRatio(segment.statistics);
    case PlotColour::kChange:
      return OfChange(segment, changes);
  }
  return std::string(kNoEvidence);
}

std::vector<LegendEntry> LegendOf(PlotColour colour) {
  std::vector<LegendEntry> entries;
  if (colour == PlotColour::kStrategy) {
    for (const Strategy strategy : {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed}) {
      entries.push_back({OfStrategy(strategy), std::string(StrategyName(strategy))});
    }
    return entries;
  }
  if (colour == PlotColour::kInlierRatio) {
    for (const double ratio : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      entries.push_back({Gradient(ratio), FixedText(ratio, 2)});
    }
  } else {
    entries = {{Gradient(0.0), "all lost"},
               {Gradient(0.25), "half lost"},
               {Gradient(0.5), "hardly changed"},
               {Gradient(1.0), "twice as good"},
               {std::string(kUnchanged), "never changed"}};
  }
  entries.push_back({std::string(kNoEvidence), "no evidence"});
  return entries;
}

}  // namespace maploc
