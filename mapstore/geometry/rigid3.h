// Rigid and similarity transforms. Named `target_from_source` everywhere, so that a chain reads
// `c_from_a = c_from_b * b_from_a` and a wrong order looks wrong.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace maploc {

struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // target_from_source, unit norm
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // of the source's origin, in target

  Eigen::Vector3d operator*(const Eigen::Vector3d& point_in_source) const {
    return rotation * point_in_source + translation;
  }
  Rigid3 Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }
};

inline Rigid3 operator*(const Rigid3& c_from_b, const Rigid3& b_from_a) {
  return {(c_from_b.rotation * b_from_a.rotation).normalized(),
          c_from_b.rotation * b_from_a.translation + c_from_b.translation};
}

// x_in_target = scale * rotation * x_in_source + translation.
struct Similarity3 {
  double scale = 1.0;  // target units a source unit; positive
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point_in_source) const {
    return scale * (rotation * point_in_source) + translation;
  }
  Similarity3 Inverse() const;
};

Similarity3 operator*(const Similarity3& c_from_b, const Similarity3& b_from_a);

// A sensor's pose moved along: given target_from_source (similarity) and camera_from_source (rigid,
// in source's unit), the rigid camera_from_target in target's unit.
Rigid3 MovePose(const Similarity3& target_from_source, const Rigid3& camera_from_source);

// Angle of the relative rotation, in radians, in [0, pi]; accurate near 0.
double RotationAngleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

}  // namespace maploc
