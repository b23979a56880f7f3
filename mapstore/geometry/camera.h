// Camera models: COLMAP's 0 to 5, with COLMAP's parameter order, and maploc's pixel convention: THE
// CENTRE OF THE FIRST PIXEL IS (0, 0). (COLMAP has it at (0.5, 0.5); formats/ subtracts the half
// pixel from principal points and keypoints when it reads.)
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "mapstore/base/status.h"
#include "mapstore/geometry/pixel_frame.h"

namespace maploc {

// The numbers are COLMAP's.
enum class CameraModel {
  kSimplePinhole = 0,  // f, cx, cy
  kPinhole = 1,        // fx, fy, cx, cy
  kSimpleRadial = 2,   // f, cx, cy, k
  kRadial = 3,         // f, cx, cy, k1, k2
  kOpenCv = 4,         // fx, fy, cx, cy, k1, k2, p1, p2
  kOpenCvFisheye = 5,  // fx, fy, cx, cy, k1, k2, k3, k4
};

inline constexpr int kMaxImageSidePx = 65536;

// "PINHOLE" etc., as COLMAP spells them.
std::string_view CameraModelName(CameraModel model);
// Number of parameters of the model.
int CameraParamCount(CameraModel model);

// Immutable after Create, hence thread-safe.
class Camera {
 public:
  // Checks everything: sides in [1, kMaxImageSidePx], the count of parameters, finite values, focal
  // lengths positive. `field` names the camera in the error, for example "views[0].camera".
  static Result<Camera> Create(CameraModel model, int width_px, int height_px,
                               std::vector<double> params, std::string_view field = "camera");

  CameraModel model() const { return model_; }
  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  const std::vector<double>& params() const { return params_; }
  Eigen::Vector2d focal_lengths_px() const;
  Eigen::Vector2d principal_point_px() const;
  // sqrt(fx fy): turns errors in the normalized plane into pixels.
  double MeanFocalLengthPx() const;
  // Whether errors in the plane z = 1 times the mean focal length are too far from pixels to be
  // taken for them: rays and Frame() serve instead.
  bool IsWide() const { return wide_; }

  // The undistorted point (x/z, y/z) in the plane z = 1 whose projection is `pixel`. Newton's
  // iterations; nullopt when they do not converge (a pixel outside of what the distortion can
  // reach) or the ray is 90 degrees or more off the axis.
  std::optional<Eigen::Vector2d> Normalize(const Eigen::Vector2d& pixel) const;
  // The unit ray whose projection is `pixel`, at any angle off the axis; nullopt outside of what
  // the distortion can reach.
  std::optional<Eigen::Vector3d> Ray(const Eigen::Vector2d& pixel) const;
  // The same ray, and how pixels change about it.
  std::optional<PixelFrame> Frame(const Eigen::Vector2d& pixel) const;
  // The pixel of a point in the camera's frame; nullopt when it is not in front of the camera: z <=
  // 0, but of a fisheye what its polynomial does not reach. Not clipped to the image.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_camera) const;

 private:
  Camera(CameraModel model, int width_px, int height_px, std::vector<double> params);

  bool LooksWide() const;
  // `distorted`: the pixel without principal point and focal lengths.
  std::optional<Eigen::Vector2d> UndistortBrown(const Eigen::Vector2d& distorted) const;
  std::optional<Eigen::Vector3d> FisheyeRay(const Eigen::Vector2d& distorted) const;
  // d distorted / d ray along the sphere.
  Eigen::Matrix<double, 2, 3> FisheyeAcross(const Eigen::Vector3d& ray) const;
  Eigen::Matrix<double, 2, 3> BrownAcross(const Eigen::Vector3d& ray) const;

  CameraModel model_;
  int width_px_;
  int height_px_;
  std::vector<double> params_;
  double max_theta_rad_ = 0.0;  // of a fisheye: as far as its polynomial rises
  bool wide_ = false;
};

}  // namespace maploc
