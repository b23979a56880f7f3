// A calibration that is not this camera's, or not this image's.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "tests/experiments/lies/lie.h"

namespace maploc::lies {
namespace {

// The camera with changed focal lengths (a factor) and principal point.
Result<Camera> Changed(const Camera& camera, double focal_factor, const Eigen::Vector2d& shift_px) {
  std::vector<double> params = camera.params();
  const bool two = camera.model() == CameraModel::kPinhole ||
                   camera.model() == CameraModel::kOpenCv ||
                   camera.model() == CameraModel::kOpenCvFisheye;
  const int focals = two ? 2 : 1;
  for (int i = 0; i < focals; ++i) params[i] *= focal_factor;
  params[focals] += shift_px.x();
  params[focals + 1] += shift_px.y();
  return Camera::Create(camera.model(), camera.width_px(), camera.height_px(), std::move(params));
}

Result<Query> WithCamera(const HonestQuery& honest, double focal_factor,
                         const Eigen::Vector2d& shift_px) {
  Query query = honest.query;
  MAPLOC_ASSIGN_OR_RETURN(query.views[0].camera,
                          Changed(query.views[0].camera, focal_factor, shift_px));
  return query;
}

Lie Focal(double factor) {
  char name[48];
  std::snprintf(name, sizeof(name), "focal length x %.2f", factor);
  return {"calibration", name, false, [factor](const HonestQuery& honest, int, Random&) {
            return WithCamera(honest, factor, Eigen::Vector2d::Zero());
          }};
}

Lie PrincipalPoint(double distance_px) {
  return {"calibration",
          "principal point " + std::to_string(static_cast<int>(distance_px)) + " px off", true,
          [distance_px](const HonestQuery& honest, int, Random& random) {
            const double angle = random.Uniform(-std::numbers::pi, std::numbers::pi);
            return WithCamera(honest, 1.0,
                              distance_px * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
          }};
}

template <typename MoveFn>
void MoveFeatures(View& view, const MoveFn& move) {
  for (auto* pixels : {&view.points.keypoints_px, &view.lines.starts_px, &view.lines.ends_px}) {
    for (Eigen::Vector2f& pixel : *pixels)
      pixel = move(pixel.cast<double>()).template cast<float>();
  }
}

// The photo was made smaller, its calibration was not. Pixel centres: u' + 0.5 = s (u + 0.5).
Lie Resized(double factor) {
  char name[32];
  std::snprintf(name, sizeof(name), "resized by %.1f", factor);
  return {"calibration", name, false,
          [factor](const HonestQuery& honest, int, Random&) -> Result<Query> {
            Query query = honest.query;
            const Eigen::Vector2d half(0.5, 0.5);
            MoveFeatures(query.views[0], [&](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
              return factor * (pixel + half) - half;
            });
            return query;
          }};
}

// The lens bends, and nobody says so: a distorting camera is sent as a pinhole; a picture without
// distortion is bent by k1 = -0.1, as a wide phone's.
Lie UndeclaredDistortion() {
  return {"calibration", "distortion undeclared", false,
          [](const HonestQuery& honest, int, Random&) -> Result<Query> {
            Query query = honest.query;
            View& view = query.views[0];
            const Camera sent = view.camera;
            const Eigen::Vector2d f = sent.focal_lengths_px();
            const Eigen::Vector2d c = sent.principal_point_px();
            const bool is_plain = sent.model() == CameraModel::kPinhole ||
                                  sent.model() == CameraModel::kSimplePinhole;
            MAPLOC_ASSIGN_OR_RETURN(view.camera,
                                    Camera::Create(CameraModel::kPinhole, sent.width_px(),
                                                   sent.height_px(), {f.x(), f.y(), c.x(), c.y()}));
            if (!is_plain) return query;
            MoveFeatures(view, [&](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
              const Eigen::Vector2d u = (pixel - c).cwiseQuotient(f);
              return c + f.cwiseProduct(u * (1.0 - 0.1 * u.squaredNorm()));
            });
            return query;
          }};
}

}  // namespace

std::vector<Lie> CalibrationLies() {
  std::vector<Lie> lies;
  for (const double factor : {0.98, 1.02, 0.95, 1.05, 0.9, 1.1, 0.7, 1.3, 0.5, 2.0}) {
    lies.push_back(Focal(factor));
  }
  for (const double distance : {20.0, 100.0}) lies.push_back(PrincipalPoint(distance));
  for (const double factor : {0.9, 0.5}) lies.push_back(Resized(factor));
  lies.push_back(UndeclaredDistortion());
  return lies;
}

}  // namespace maploc::lies
