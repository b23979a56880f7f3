// A model's triangulated points with the descriptors of their observations.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/formats/colmap.h"
#include "mapstore/importers/tracks.h"

namespace maploc {

// What one frame has to give: features, and which of them (or -1) belongs to each keypoint of the
// model's image.
struct KeypointFeatures {
  Descriptors descriptors;
  std::vector<std::int32_t> row_of_keypoint;
};

// The database's features; a keypoint is the row of the same index. One entry a frame. Error names
// an image that the database lacks, or whose keypoints are not the model's (1 px apart or more).
Result<std::vector<KeypointFeatures>> TakeFromDatabase(
    const ColmapModel& model, std::span<const KeyFrame> frames,
    std::map<std::string, ColmapFeatures> database);

// Detected features: for each keypoint that saw a point the nearest one within max_distance_px.
KeypointFeatures AttachFeatures(const ColmapImage& image, const PointFeatures& features,
                                double max_distance_px);

// Points that have a descriptor, at most max_descriptors each, ascending by the source's id.
std::vector<PointTrack> MakePointTracks(const ColmapModel& model,
                                        const Similarity3& map_from_source,
                                        std::span<const KeyFrame> frames,
                                        std::span<const KeypointFeatures> features,
                                        int max_descriptors);

}  // namespace maploc
