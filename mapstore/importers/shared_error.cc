#include "mapstore/importers/shared_error.h"

#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace maploc {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kSteps = 5;
constexpr double kLossPx = 3.0;  // Cauchy's: a wrong observation must not move the frame

// What is seen is compared in the plane z = 1 of an eye that has the camera's axes; in a wide
// camera, whose rim has no place in that plane, the eye looks at the feature.
struct Observation {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // from the camera's centre as it was given
  Eigen::Matrix3d eye_from_camera = Eigen::Matrix3d::Identity();
  Eigen::Vector2d seen = Eigen::Vector2d::Zero();
  double views = 2.0;  // frames that made the landmark
};

struct Pose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;

  Eigen::Vector3d InEye(const Observation& seen) const {
    return seen.eye_from_camera * (rotation * seen.position + translation);
  }
  std::optional<Eigen::Vector2d> Project(const Observation& seen) const {
    const Eigen::Vector3d q = InEye(seen);
    if (!(q.z() > 0)) return std::nullopt;
    return Eigen::Vector2d(q.head<2>() / q.z());
  }
};

// nullopt: the lens does not reach there.
std::optional<Observation> Observe(const Camera& camera, const Eigen::Vector2d& pixel) {
  Observation observation;
  if (camera.IsWide()) {
    const auto ray = camera.Ray(pixel);
    if (!ray) return std::nullopt;
    observation.eye_from_camera =
        Eigen::Quaterniond::FromTwoVectors(*ray, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return observation;
  }
  const auto seen = camera.Normalize(pixel);
  if (!seen) return std::nullopt;
  observation.seen = *seen;
  return observation;
}

std::vector<Observation> ObservationsOf(const ColmapModel& model, const ColmapImage& image) {
  const Camera& camera = model.cameras.at(image.camera_id);
  const Eigen::Vector3d centre = image.camera_from_source.Inverse().translation;
  std::vector<Observation> observations;
  for (std::size_t i = 0; i < image.point_ids.size(); ++i) {
    const auto point = model.points.find(image.point_ids[i]);
    if (point == model.points.end() || point->second.track.size() < 2) continue;
    std::optional<Observation> seen = Observe(camera, image.keypoints_px[i]);
    if (!seen) continue;
    seen->position = point->second.position_in_source - centre;
    seen->views = static_cast<double>(point->second.track.size());
    observations.push_back(*seen);
  }
  return observations;
}

// One step of Gauss-Newton on the left perturbation (turn, shift).
void Refine(const std::vector<Observation>& observations, double loss, Pose* pose) {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (const Observation& seen : observations) {
    const auto projected = pose->Project(seen);
    if (!projected) continue;
    const Eigen::Vector3d turned = pose->rotation * seen.position;
    const double depth = pose->InEye(seen).z();
    const Eigen::Vector2d error = *projected - seen.seen;
    const double weight = 1.0 / (1.0 + error.squaredNorm() / (loss * loss));
    Eigen::Matrix<double, 2, 6> jacobian;
    for (int i = 0; i < 2; ++i) {
      // The derivative of the projection's coordinate i by the point in the eye's frame, then in
      // the camera's.
      Eigen::Vector3d in_eye = Eigen::Vector3d::Unit(i) / depth;
      in_eye.z() = -(*projected)(i) / depth;
      const Eigen::Vector3d by_point = seen.eye_from_camera.transpose() * in_eye;
      jacobian.row(i) << turned.cross(by_point).transpose(), by_point.transpose();
    }
    matrix.noalias() += weight * jacobian.transpose() * jacobian;
    right.noalias() -= weight * jacobian.transpose() * error;
  }
  const Vector6 step = matrix.ldlt().solve(right);
  if (!step.allFinite()) return;
  const double angle = step.head<3>().norm();
  if (angle > 0) {
    pose->rotation =
        Eigen::AngleAxisd(angle, step.head<3>() / angle).toRotationMatrix() * pose->rotation;
  }
  pose->translation += step.tail<3>();
}

// Of the landmarks that the frame sees, of one coordinate: mean square of what they share; nullopt
// where there are too few. The frame's own error shows but for 1 / m of it; the mean of m frames'
// errors is the landmark's.
std::optional<double> MeanSquareShared(const ColmapModel& model, const ColmapImage& image) {
  const std::vector<Observation> observations = ObservationsOf(model, image);
  if (static_cast<int>(observations.size()) < kLeastObservations) return std::nullopt;
  // About the centre: a turn about a far origin would drown the frame's own errors in rounding.
  const Pose given{image.camera_from_source.rotation.toRotationMatrix(), Eigen::Vector3d::Zero()};
  Pose refined = given;
  const double loss = kLossPx / model.cameras.at(image.camera_id).MeanFocalLengthPx();
  for (int i = 0; i < kSteps; ++i) Refine(observations, loss, &refined);
  double moved = 0.0;
  double shown = 0.0;
  double shared = 0.0;
  for (const Observation& seen : observations) {
    const auto before = given.Project(seen);
    const auto after = refined.Project(seen);
    if (!before || !after) continue;
    const double share = (seen.views - 1.0) / seen.views;
    moved += 0.5 * (*after - *before).squaredNorm();
    shown += share * share;
    shared += 1.0 / seen.views;
  }
  if (!(shown > 0)) return std::nullopt;
  return moved / shown * shared / static_cast<double>(observations.size());
}

}  // namespace

double SharedErrorRad(const ColmapModel& model) {
  double sum = 0.0;
  int frames = 0;
  for (const auto& [id, image] : model.images) {
    const auto shared = MeanSquareShared(model, image);
    if (!shared) continue;
    sum += *shared;
    ++frames;
  }
  return frames > 0 ? std::sqrt(sum / frames) : 0.0;
}

}  // namespace maploc
