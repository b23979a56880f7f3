// A map's plan as a picture: landmarks in grey, each segment's path in the colour of its strategy.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapstore/model/map.h"
#include "mapstore/store/map_store.h"

namespace maploc {

// An SVG document, seen from above, x to the right and y up. `segments` and `landmarks` run in
// parallel.
std::string PlotSvg(const std::string& title, const std::vector<SegmentSummary>& segments,
                    const std::vector<std::shared_ptr<const Segment>>& landmarks);

}  // namespace maploc
