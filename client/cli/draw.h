// The photo with what was found in it, for a person to judge an answer.
#pragma once

#include <string>

#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/query.h"

namespace maploc {

// Writes the photo at `photo_path` in grey to `out_path` (format by its ending) with points as
// circles and lines as strokes: inliers green (points) and blue (lines), other matches red and
// orange, unmatched features thin and grey. REQUIRES: the matches of `localization` index features
// of `view`.
Status DrawLocalization(const std::string& photo_path, const View& view,
                        const Localization& localization, const std::string& out_path);

}  // namespace maploc
