#include "mapstore/geometry/camera.h"

#include <array>
#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mapstore/geometry/fisheye.h"

namespace maploc {
namespace {

struct ModelTraits {
  CameraModel model;
  std::string_view name;
  int param_count;
  bool two_focal_lengths;
};

// In the order of the enum, whose numbers are COLMAP's: Traits uses them as indices.
constexpr std::array<ModelTraits, 6> kModels = {{
    {CameraModel::kSimplePinhole, "SIMPLE_PINHOLE", 3, false},
    {CameraModel::kPinhole, "PINHOLE", 4, true},
    {CameraModel::kSimpleRadial, "SIMPLE_RADIAL", 4, false},
    {CameraModel::kRadial, "RADIAL", 5, false},
    {CameraModel::kOpenCv, "OPENCV", 8, true},
    {CameraModel::kOpenCvFisheye, "OPENCV_FISHEYE", 8, true},
}};

const ModelTraits& Traits(CameraModel model) { return kModels[static_cast<int>(model)]; }

// Distortion in the normalized plane: radial k1, k2 and tangential p1, p2 (Brown), as OpenCV's
// pinhole model.
Eigen::Vector2d DistortBrown(const Eigen::Vector2d& u, double k1, double k2, double p1, double p2) {
  const double r2 = u.squaredNorm();
  const double radial = r2 * (k1 + k2 * r2);
  const double xy = u.x() * u.y();
  return {u.x() * (1 + radial) + 2 * p1 * xy + p2 * (r2 + 2 * u.x() * u.x()),
          u.y() * (1 + radial) + 2 * p2 * xy + p1 * (r2 + 2 * u.y() * u.y())};
}

Eigen::Vector2d Distort(CameraModel model, const double* params, const Eigen::Vector2d& u) {
  switch (model) {
    case CameraModel::kSimplePinhole:
    case CameraModel::kPinhole:
      return u;
    case CameraModel::kSimpleRadial:
      return DistortBrown(u, params[3], 0, 0, 0);
    case CameraModel::kRadial:
      return DistortBrown(u, params[3], params[4], 0, 0);
    case CameraModel::kOpenCv:
      return DistortBrown(u, params[4], params[5], params[6], params[7]);
    case CameraModel::kOpenCvFisheye:
      break;  // knows no plane: fisheye.h
  }
  return u;
}

// d distorted / d undistorted by central differences: exact enough for Newton, and one code for
// every model.
Eigen::Matrix2d DistortionJacobian(CameraModel model, const double* params,
                                   const Eigen::Vector2d& u) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix2d jacobian;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
    jacobian.col(axis) =
        (Distort(model, params, u + step) - Distort(model, params, u - step)) / (2 * kStep);
  }
  return jacobian;
}

// How much the lens scales lengths in the plane z = 1; on the axis the scale is 1. Within these
// bounds errors measured in the plane are as good as errors of rays, and faster (EuRoC's corners
// have 0.65).
constexpr double kLeastPlaneScale = 0.5;
constexpr double kMostPlaneScale = 2.0;

// Further off the axis the plane z = 1 is no place for a ray: 0.01 rad short of 90 degrees.
constexpr double kMaxPlaneTheta = 1.5607;

}  // namespace

std::string_view CameraModelName(CameraModel model) { return Traits(model).name; }

int CameraParamCount(CameraModel model) { return Traits(model).param_count; }

Camera::Camera(CameraModel model, int width_px, int height_px, std::vector<double> params)
    : model_(model), width_px_(width_px), height_px_(height_px), params_(std::move(params)) {
  if (model_ == CameraModel::kOpenCvFisheye) max_theta_rad_ = MaxBendableAngle(&params_[4]);
  wide_ = LooksWide();
}

Result<Camera> Camera::Create(CameraModel model, int width_px, int height_px,
                              std::vector<double> params, std::string_view field) {
  const std::string name(field);
  const auto bad_side = [](int side) { return side < 1 || side > kMaxImageSidePx; };
  if (bad_side(width_px)) return InvalidArgument(name + ".width", "must be in [1, 65536]");
  if (bad_side(height_px)) return InvalidArgument(name + ".height", "must be in [1, 65536]");
  const ModelTraits& traits = Traits(model);
  if (static_cast<int>(params.size()) != traits.param_count) {
    return InvalidArgument(name + ".params", std::string(traits.name) + " takes " +
                                                 std::to_string(traits.param_count) +
                                                 " parameters, got " +
                                                 std::to_string(params.size()));
  }
  for (std::size_t i = 0; i < params.size(); ++i) {
    const std::string param = name + ".params[" + std::to_string(i) + "]";
    if (!std::isfinite(params[i])) return InvalidArgument(param, "must be finite");
    const bool is_focal = i == 0 || (i == 1 && traits.two_focal_lengths);
    if (is_focal && !(params[i] > 0)) {
      return InvalidArgument(param, "the focal length must be positive, in pixels");
    }
  }
  return Camera(model, width_px, height_px, std::move(params));
}

Eigen::Vector2d Camera::focal_lengths_px() const {
  return {params_[0], params_[Traits(model_).two_focal_lengths ? 1 : 0]};
}

Eigen::Vector2d Camera::principal_point_px() const {
  const int first = Traits(model_).two_focal_lengths ? 2 : 1;
  return {params_[first], params_[first + 1]};
}

double Camera::MeanFocalLengthPx() const {
  const Eigen::Vector2d f = focal_lengths_px();
  return std::sqrt(f.x() * f.y());
}

bool Camera::LooksWide() const {
  if (model_ == CameraModel::kOpenCvFisheye) return true;
  // From the axis to the corner that is furthest: distortion is radial but for a little.
  const Eigen::Vector2d centre = principal_point_px();
  const Eigen::Vector2d corner(centre.x() < 0.5 * width_px_ ? width_px_ - 1.0 : 0.0,
                               centre.y() < 0.5 * height_px_ ? height_px_ - 1.0 : 0.0);
  // All along the radius, because a polynomial can squeeze a ring inside the image.
  constexpr int kLooks = 8;
  for (int i = 1; i <= kLooks; ++i) {
    const Eigen::Vector2d offset = static_cast<double>(i) / kLooks * (corner - centre);
    const auto u = UndistortBrown(offset.cwiseQuotient(focal_lengths_px()));
    if (!u) return true;  // the image reaches a fold, where the scale goes to zero
    const double area = DistortionJacobian(model_, params_.data(), *u).determinant();
    if (area < kLeastPlaneScale * kLeastPlaneScale || area > kMostPlaneScale * kMostPlaneScale) {
      return true;
    }
  }
  return false;
}

std::optional<Eigen::Vector2d> Camera::Normalize(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d distorted =
      (pixel - principal_point_px()).cwiseQuotient(focal_lengths_px());
  if (model_ == CameraModel::kOpenCvFisheye) {
    const std::optional<Eigen::Vector3d> ray = FisheyeRay(distorted);
    if (!ray || ray->z() < std::cos(kMaxPlaneTheta)) return std::nullopt;
    return ray->hnormalized();
  }
  return UndistortBrown(distorted);
}

std::optional<Eigen::Vector2d> Camera::UndistortBrown(const Eigen::Vector2d& distorted) const {
  if (model_ == CameraModel::kSimplePinhole || model_ == CameraModel::kPinhole) return distorted;
  Eigen::Vector2d u = distorted;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d error = Distort(model_, params_.data(), u) - distorted;
    const Eigen::Matrix2d jacobian = DistortionJacobian(model_, params_.data(), u);
    // Past the fold of the polynomial the inverse is another branch: not this pixel's ray.
    if (!(jacobian.determinant() > 1e-6)) return std::nullopt;
    const Eigen::Vector2d step = jacobian.inverse() * error;
    u -= step;
    if (step.squaredNorm() < 1e-24) return u;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3d> Camera::FisheyeRay(const Eigen::Vector2d& distorted) const {
  const double bent = distorted.norm();
  // Near the axis sin(theta) / bent is 0 / 0; the ray is the axis to first order.
  if (bent < 1e-12) return Eigen::Vector3d(distorted.x(), distorted.y(), 1.0);
  const std::optional<double> theta = Unbend(&params_[4], max_theta_rad_, bent);
  if (!theta) return std::nullopt;
  const Eigen::Vector2d outwards = std::sin(*theta) / bent * distorted;
  return Eigen::Vector3d(outwards.x(), outwards.y(), std::cos(*theta));
}

std::optional<Eigen::Vector3d> Camera::Ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d distorted =
      (pixel - principal_point_px()).cwiseQuotient(focal_lengths_px());
  if (model_ == CameraModel::kOpenCvFisheye) return FisheyeRay(distorted);
  const std::optional<Eigen::Vector2d> plane = UndistortBrown(distorted);
  if (!plane) return std::nullopt;
  return plane->homogeneous().normalized();
}

std::optional<PixelFrame> Camera::Frame(const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector3d> ray = Ray(pixel);
  if (!ray) return std::nullopt;
  PixelFrame frame;
  frame.ray = *ray;
  frame.across = focal_lengths_px().asDiagonal() *
                 (model_ == CameraModel::kOpenCvFisheye ? FisheyeAcross(*ray) : BrownAcross(*ray));
  return frame;
}

// d distorted / d ray. Along the meridian the polynomial's slope; around the axis a circle of the
// length 2 pi bent for one of 2 pi sin theta.
Eigen::Matrix<double, 2, 3> Camera::FisheyeAcross(const Eigen::Vector3d& ray) const {
  const double sine = ray.head<2>().norm();
  // On the axis there is no meridian, and the polynomial's slope is 1.
  if (sine < 1e-9) return Eigen::Matrix<double, 2, 3>::Identity();
  const double theta = std::atan2(sine, ray.z());
  const Eigen::Vector2d outwards = ray.head<2>() / sine;
  const Eigen::Vector2d around(-outwards.y(), outwards.x());
  const Eigen::RowVector3d along_meridian(ray.z() * outwards.x(), ray.z() * outwards.y(), -sine);
  const Eigen::RowVector3d along_circle(around.x(), around.y(), 0.0);
  return BendSlope(&params_[4], theta) * outwards * along_meridian +
         Bend(&params_[4], theta) / sine * around * along_circle;
}

Eigen::Matrix<double, 2, 3> Camera::BrownAcross(const Eigen::Vector3d& ray) const {
  const Eigen::Vector2d u = ray.hnormalized();
  Eigen::Matrix<double, 2, 3> by_ray;
  by_ray << 1, 0, -u.x(), 0, 1, -u.y();
  // The derivative of (x / z, y / z) by the ray is by_ray / z.
  return DistortionJacobian(model_, params_.data(), u) * by_ray / ray.z();
}

std::optional<Eigen::Vector2d> Camera::Project(const Eigen::Vector3d& point_in_camera) const {
  Eigen::Vector2d distorted;
  if (model_ == CameraModel::kOpenCvFisheye) {
    const double radius = point_in_camera.head<2>().norm();
    const double theta = std::atan2(radius, point_in_camera.z());
    // The camera's own centre has no direction, though atan2(0, 0) is 0.
    if (theta > max_theta_rad_ || point_in_camera.isZero(0)) return std::nullopt;
    // On the axis the direction does not matter.
    const double bent = Bend(&params_[4], theta);
    distorted = radius > 0 ? Eigen::Vector2d(bent / radius * point_in_camera.head<2>())
                           : Eigen::Vector2d::Zero();
  } else {
    if (!(point_in_camera.z() > 0)) return std::nullopt;
    distorted = Distort(model_, params_.data(), point_in_camera.hnormalized());
  }
  return distorted.cwiseProduct(focal_lengths_px()) + principal_point_px();
}

}  // namespace maploc
