#include "mapstore/geometry/rigid3.h"

#include <cmath>

namespace maploc {

Similarity3 Similarity3::Inverse() const {
  const Eigen::Quaterniond inverse = rotation.conjugate();
  return {1.0 / scale, inverse, -(inverse * translation) / scale};
}

Similarity3 operator*(const Similarity3& c_from_b, const Similarity3& b_from_a) {
  // Normalized, so that rounding does not add up along a chain of transforms.
  return {c_from_b.scale * b_from_a.scale, (c_from_b.rotation * b_from_a.rotation).normalized(),
          c_from_b * b_from_a.translation};
}

Rigid3 MovePose(const Similarity3& target_from_source, const Rigid3& camera_from_source) {
  // camera_from_target * x_target must see the same direction as camera_from_source * x_source,
  // scaled: substitute x_source = target_from_source^-1 * x_target and multiply by the scale.
  const Eigen::Quaterniond rotation =
      (camera_from_source.rotation * target_from_source.rotation.conjugate()).normalized();
  return {rotation, target_from_source.scale * camera_from_source.translation -
                        rotation * target_from_source.translation};
}

double RotationAngleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond relative = a.conjugate() * b;
  // q and -q are the same rotation, hence the absolute value. acos(w) would be inaccurate near 0.
  return 2.0 * std::atan2(relative.vec().norm(), std::abs(relative.w()));
}

}  // namespace maploc
