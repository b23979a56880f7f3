// A map's plan as a picture: landmarks in grey, each segment's path in a colour that tells
// something.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapstore/model/map.h"
#include "mapstore/store/map_store.h"
#include "mapstore/tools/decline.h"

namespace maploc {

enum class PlotColour {
  kStrategy,     // of the segment
  kInlierRatio,  // of points; of lines where there are none
  kChange,       // what is left since the last changes, of what lost most or gained least
};

// An SVG document, seen from above, x to the right and y up. `segments`, `changes` and `landmarks`
// run in parallel.
std::string PlotSvg(const std::string& title, PlotColour colour,
                    const std::vector<SegmentSummary>& segments,
                    const std::vector<SegmentChanges>& changes,
                    const std::vector<std::shared_ptr<const Segment>>& landmarks);

}  // namespace maploc
