// Packed keypoints and line segments with their descriptors. Internal to proto/convert.
#pragma once

#include <string>

#include "maploc/v1/localization_service.pb.h"
#include "mapstore/base/status.h"
#include "mapstore/model/query.h"

namespace maploc::convert {

// At most kMaxFeatures (RESOURCE_EXHAUSTED, TOO_MANY_FEATURES), coordinates a multiple of two (four
// for lines), finite and within kMaxCoordinatePx; descriptors exactly one row a feature.
Result<PointFeatures> PointFeaturesFromProto(const v1::Features& features,
                                             const std::string& field);
// Beside those: no segment of length zero (DEGENERATE_LINE).
Result<LineFeatures> LineFeaturesFromProto(const v1::Features& features, const std::string& field);

void PointFeaturesToProto(const PointFeatures& points, v1::Features* proto);
void LineFeaturesToProto(const LineFeatures& lines, v1::Features* proto);

}  // namespace maploc::convert
