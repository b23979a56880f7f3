// What a recorded robot says about gravity: measured values from a file, or the reference's own
// direction, turned by noise.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/base/status.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/query.h"

namespace maploc {

struct GravityOptions {
  bool none = false;                // no query has a gravity; the others then say nothing
  std::string csv;                  // formats/colmap.h ReadGravityCsv; empty: from the reference
  double noise_deg = 0.0;           // standard deviation about each horizontal axis, with no csv
  std::optional<double> sigma_deg;  // that is sent; default: noise_deg, or 1 with a csv
  std::uint64_t seed = 1;
};

// The wire has no place for a sigma of zero, and no reference pose is better than this.
inline constexpr double kMinGravitySigmaDeg = 0.05;

// Gravity in the camera: (0, 0, -1) of the map turned about the map's x and y axes by two
// independent normal angles of `noise_rad`.
Eigen::Vector3d NoisyGravityInCamera(const Eigen::Quaterniond& camera_from_map, double noise_rad,
                                     Random& random);

// Thread-safe once made.
class GravitySource {
 public:
  // INVALID_ARGUMENT: a noise outside of 0 to 90 degrees, a stated sigma outside of (0, 90], or
  // what is wrong in the file.
  static Result<GravitySource> Create(const GravityOptions& options);

  // NOT_FOUND (NO_GRAVITY): how many of these images the file lacks, the first few, and the cure.
  Status CheckHas(const std::vector<std::string>& image_names) const;

  // The same image has the same noise whatever else is asked. NOT_FOUND: the file lacks the image.
  Result<Gravity> For(const std::string& image_name, const Rigid3& camera_from_map) const;

 private:
  GravityOptions options_;
  double sigma_rad_ = 0.0;
  std::map<std::string, Eigen::Vector3d> measured_in_camera_;
};

}  // namespace maploc
