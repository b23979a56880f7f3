// The colours of plans, and what they mean.
#pragma once

#include <string>
#include <vector>

#include "mapstore/tools/plot_svg.h"

namespace maploc {

std::string ColourOf(PlotColour colour, const SegmentSummary& segment,
                     const SegmentChanges& changes);

struct LegendEntry {
  std::string colour;
  std::string text;
};
std::vector<LegendEntry> LegendOf(PlotColour colour);

}  // namespace maploc
