#include "client/robot/gravity_source.h"

#include <algorithm>
#include <cmath>

#include "client/robot/missing.h"
#include "mapstore/base/angles.h"
#include "mapstore/formats/colmap.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/geometry/gravity_reading.h"

namespace maploc {
namespace {

constexpr double kCsvSigmaDeg = 1.0;  // of an ordinary IMU, moving

// Zero is the reference's own direction.
Status CheckNoise(double degrees) {
  if (std::isfinite(degrees) && degrees >= 0.0 && degrees <= 90.0) return Status::Ok();
  return InvalidArgument("--gravity-noise-deg", "must lie in 0 to 90 degrees");
}

}  // namespace

Eigen::Vector3d NoisyGravityInCamera(const Eigen::Quaterniond& camera_from_map, double noise_rad,
                                     Random& random) {
  // A turn about the vertical would leave gravity as it is.
  const Eigen::AngleAxisd about_x(random.Gaussian(noise_rad), Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd about_y(random.Gaussian(noise_rad), Eigen::Vector3d::UnitY());
  return (camera_from_map * (about_x * (about_y * kGravityInMap))).normalized();
}

Result<GravitySource> GravitySource::Create(const GravityOptions& options) {
  const double sigma_deg =
      options.sigma_deg.value_or(options.csv.empty() ? options.noise_deg : kCsvSigmaDeg);
  MAPLOC_RETURN_IF_ERROR(CheckNoise(options.noise_deg));
  if (options.sigma_deg) {
    MAPLOC_RETURN_IF_ERROR(CheckGravitySigmaDeg("--gravity-sigma-deg", *options.sigma_deg));
  }
  GravitySource source;
  source.options_ = options;
  source.sigma_rad_ = std::max(sigma_deg, kMinGravitySigmaDeg) * kRadPerDeg;
  if (!options.csv.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(source.measured_in_camera_, ReadGravityCsv(options.csv));
  }
  return source;
}

Result<Gravity> GravitySource::For(const std::string& image_name,
                                   const Rigid3& camera_from_map) const {
  if (options_.csv.empty()) {
    // A generator of the image's own: a query must be the same in every run, whichever were asked
    // before it.
    Random random = Random(options_.seed).Fork(HashBytes(image_name));
    return Gravity{
        NoisyGravityInCamera(camera_from_map.rotation, options_.noise_deg * kRadPerDeg, random),
        sigma_rad_};
  }
  const auto measured = measured_in_camera_.find(image_name);
  if (measured == measured_in_camera_.end()) {
    return NotFound("gravity of image '" + image_name + "' in " + options_.csv, "NO_GRAVITY");
  }
  return Gravity{measured->second, sigma_rad_};
}

Status GravitySource::CheckHas(const std::vector<std::string>& image_names) const {
  if (options_.csv.empty()) return Status::Ok();
  std::vector<std::string> missing;
  for (const std::string& name : image_names) {
    if (!measured_in_camera_.contains(name)) missing.push_back(name);
  }
  if (missing.empty()) return Status::Ok();
  return Status(StatusCode::kNotFound, "NO_GRAVITY",
                MissingText(missing, image_names.size(), "gravity in " + options_.csv) +
                    "; add a row name,gx,gy,gz for each, or leave --gravity-csv out to send the "
                    "reference's direction");
}

}  // namespace maploc
