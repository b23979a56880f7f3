// The strongest of too many keypoints.
#pragma once

#include <vector>

#include "mapstore/model/query.h"

namespace maploc {

// At most `max_features` of `points`, in their order: those of the largest scale (a database keeps
// no response; a large keypoint is found again from elsewhere), the earlier one of two alike.
// `scales_px` empty: none is known, and every n-th is kept, evenly over the list. REQUIRES:
// max_features >= 1; as many scales as points, or none.
PointFeatures Strongest(PointFeatures points, const std::vector<float>& scales_px,
                        int max_features);

}  // namespace maploc
