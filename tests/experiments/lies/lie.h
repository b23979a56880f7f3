// What careless users and mishaps send: an honest recorded query, with one input that lies.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/base/status.h"
#include "mapstore/model/query.h"

namespace maploc::lies {

// A recorded query before it is changed. Body is the camera.
struct HonestQuery {
  std::string name;
  Query query;
  Rigid3 map_from_camera;     // the reference
  double median_depth = 0.0;  // of the landmarks in the picture, map units
  std::string photo;          // its file; empty where there is none
};

// Makes the query that is sent. `draw` counts the repetitions of a lie with one query; `random` is
// its own. FAILED_PRECONDITION where the lie does not apply to the query (no photo to mirror).
using TellFn = std::function<Result<Query>(const HonestQuery& honest, int draw, Random& random)>;

struct Lie {
  std::string family;  // honest, gravity, mirror, calibration, patch, few
  std::string name;
  bool is_random = false;  // told several times a query, each drawn anew
  TellFn tell;
};

// All of them, honest ones first.
std::vector<Lie> AllLies();

// The families, each in a file of its own.
std::vector<Lie> GravityLies();
std::vector<Lie> CalibrationLies();
std::vector<Lie> FeatureLies();  // honest subsets of the features as well

// A random subset of `count` keypoints in their order; all where there are no more.
void KeepSomePoints(int count, Random& random, PointFeatures& points);

}  // namespace maploc::lies
