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

struct Observation {
  Eigen::Vector3d position;
  Eigen::Vector2d seen;  // plane z = 1
  double views = 2.0;    // frames that made the landmark
};

struct Pose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;

  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& position) const {
    const Eigen::Vector3d q = rotation * position + translation;
    if (!(q.z() > 0)) return std::nullopt;
    return Eigen::Vector2d(q.head<2>() / q.z());
  }
};

std::vector<Observation> ObservationsOf(const ColmapModel& model, const ColmapImage& image) {
  const Camera& camera = model.cameras.at(image.camera_id);
  std::vector<Observation> observations;
  for (std::size_t i = 0; i < image.point_ids.size(); ++i) {
    const auto point = model.points.find(image.point_ids[i]);
    if (point == model.points.end() || point->second.track.size() < 2) continue;
    const auto seen = camera.Normalize(image.keypoints_px[i]);
    if (!seen) continue;
    const double views = static_cast<double>(point->second.track.size());
    observations.push_back({point->second.position_in_source, *seen, views});
  }
  return observations;
}

// One step of Gauss-Newton on the left perturbation (turn, shift).
void Refine(const std::vector<Observation>& observations, double loss, Pose* pose) {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (const Observation& seen : observations) {
    const auto projected = pose->Project(seen.position);
    if (!projected) continue;
    const Eigen::Vector3d turned = pose->rotation * seen.position;
    const double depth = (turned + pose->translation).z();
    const Eigen::Vector2d error = *projected - seen.seen;
    const double weight = 1.0 / (1.0 + error.squaredNorm() / (loss * loss));
    Eigen::Matrix<double, 2, 6> jacobian;
    for (int i = 0; i < 2; ++i) {
      Eigen::Vector3d by_point = Eigen::Vector3d::Unit(i) / depth;
      by_point.z() = -(*projected)(i) / depth;
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
  const Pose given{image.camera_from_source.rotation.toRotationMatrix(),
                   image.camera_from_source.translation};
  Pose refined = given;
  const double loss = kLossPx / model.cameras.at(image.camera_id).MeanFocalLengthPx();
  for (int i = 0; i < kSteps; ++i) Refine(observations, loss, &refined);
  double moved = 0.0;
  double shown = 0.0;
  double shared = 0.0;
  for (const Observation& seen : observations) {
    const auto before = given.Project(seen.position);
    const auto after = refined.Project(seen.position);
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
