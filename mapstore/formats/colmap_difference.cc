#include "mapstore/formats/colmap_difference.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace maploc {
namespace {

// COLMAP's text had six digits once, and has 17 now.
constexpr double kRounding = 1e-5;

// Relative for large numbers and absolute near 0, as a number of digits rounds.
bool IsNear(double a, double b) { return std::abs(a - b) <= kRounding * (1 + std::abs(a)); }

template <typename Vectors>
bool AreNear(const Vectors& a, const Vectors& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& u, const auto& v) {
    return std::equal(u.begin(), u.end(), v.begin(), v.end(), IsNear);
  });
}

std::string Difference(const Camera& a, const Camera& b) {
  const std::vector<double>& params = a.params();
  const bool is_same = a.model() == b.model() && a.width_px() == b.width_px() &&
                       a.height_px() == b.height_px() &&
                       std::equal(params.begin(), params.end(), b.params().begin(), IsNear);
  return is_same ? "" : "has another calibration";
}

std::string Difference(const ColmapImage& a, const ColmapImage& b) {
  if (a.name != b.name) return "has another name";
  if (a.camera_id != b.camera_id) return "has another camera";
  const Rigid3& pose = a.camera_from_source;
  const Rigid3& other = b.camera_from_source;
  if (pose.rotation.angularDistance(other.rotation) > kRounding ||
      !AreNear(std::array{pose.translation}, std::array{other.translation})) {
    return "has another pose";
  }
  const bool is_same = a.point_ids == b.point_ids && AreNear(a.keypoints_px, b.keypoints_px);
  return is_same ? "" : "has other keypoints";
}

std::string Difference(const ColmapPoint& a, const ColmapPoint& b) {
  if (!AreNear(std::array{a.position_in_source}, std::array{b.position_in_source})) {
    return "has another position";
  }
  const bool is_same = std::equal(a.track.begin(), a.track.end(), b.track.begin(), b.track.end(),
                                  [](const auto& u, const auto& v) {
                                    return u.image_id == v.image_id && u.keypoint == v.keypoint;
                                  });
  return is_same ? "" : "has another track";
}

template <typename Parts>
std::string FindDifference(const std::string& what, const Parts& a, const Parts& b) {
  for (const auto& [id, part] : a) {
    const std::string name = what + " " + std::to_string(id) + " ";
    const auto other = b.find(id);
    if (other == b.end()) return name + "is missing there";
    if (const std::string how = Difference(part, other->second); !how.empty()) return name + how;
  }
  if (a.size() != b.size()) return "there are more " + what + "s there";
  return "";
}

}  // namespace

std::string FindModelDifference(const ColmapModel& a, const ColmapModel& b) {
  std::string difference = FindDifference("camera", a.cameras, b.cameras);
  if (difference.empty()) difference = FindDifference("image", a.images, b.images);
  if (difference.empty()) difference = FindDifference("point", a.points, b.points);
  return difference;
}

}  // namespace maploc
