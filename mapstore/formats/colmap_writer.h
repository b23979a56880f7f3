// COLMAP's files written: what a made-up world needs to come in through the importer's door, as any
// real one does. Half a pixel is added back to principal points and keypoints.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/formats/colmap.h"

namespace maploc {

// DIR/{cameras,images,points3D}.txt; makes DIR. REQUIRES: a consistent model (every camera, image
// and keypoint that is referred to exists).
Status WriteColmapModel(const std::string& directory, const ColmapModel& model);

// A camera's parameters with COLMAP's principal point, half a pixel further.
std::vector<double> ColmapCameraParams(const Camera& camera);

// A new database.db with COLMAP's tables: the model's cameras and images, and the features of each
// image by name. An existing file is replaced. REQUIRES: as many descriptor rows as keypoints;
// every name in `features` is an image of the model.
Status WriteColmapDatabase(const std::string& path, const ColmapModel& model,
                           const std::map<std::string, PointFeatures>& features);

}  // namespace maploc
