#include "tests/support/repeated_pattern.h"

#include <numbers>

#include "mapstore/geometry/rigid3.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kWidth = 8.0;   // of the facade, in metres
constexpr double kHeight = 5.0;  // of the facade
constexpr double kEdge = 0.4;    // length of a window's edge
constexpr double kFocalPx = 500.0;
constexpr double kGravitySigmaRad = 0.5 * std::numbers::pi / 180.0;

Rigid3 CameraInFront() {
  Eigen::Matrix3d rotation;  // level, looking along x
  rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return {Eigen::Quaterniond(rotation), {0, 0, 8}};
}

struct Window {
  int column = 0;
  int row = 0;
};

// A window and a spot in it, seen; and another window's, in the map.
class Facade {
 public:
  Facade(const RepeatedPatternOptions& options, Random& random)
      : options_(options),
        random_(random),
        columns_(6 + static_cast<int>(random.Below(8))),
        rows_(3 + static_cast<int>(random.Below(4))),
        kinds_(1 + random.Below(8)) {
    if (options.shifted_share > 0) {
      shift_ = {1 + static_cast<int>(random.Below(2)), static_cast<int>(random.Below(2))};
    }
  }

  void AddMatch(PoseProblem* problem) {
    const bool shifted = options_.shifted_share > 0 && random_.Uniform() < options_.shifted_share;
    // One of `kinds` spots of some window, taken for the same spot of another.
    const double across = random_.Below(kinds_) / (kinds_ + 1.0);
    const double up = random_.Below(2) / 2.0;
    const Window seen = RandomWindow();
    const Window known =
        shifted ? Window{seen.column + shift_.column, seen.row + shift_.row} : RandomWindow();
    if (random_.Uniform() < options_.line_share) {
      AddLine(Spot(seen, across, up), Spot(known, across, up), problem);
    } else {
      problem->points.push_back(
          {.normalized = See(Spot(seen, across, up)), .position_in_map = Spot(known, across, up)});
    }
  }

 private:
  void AddLine(const Eigen::Vector3d& seen, const Eigen::Vector3d& known, PoseProblem* problem) {
    const Eigen::Vector3d along =
        random_.Below(2) == 0 ? Eigen::Vector3d(0, kEdge, 0) : Eigen::Vector3d(0, 0, kEdge);
    problem->lines.push_back(
        {.normalized = {See(seen), See(seen + along)}, .segment_in_map = {known, known + along}});
  }
  Window RandomWindow() {
    const int column = static_cast<int>(random_.Below(columns_));
    const int row = static_cast<int>(random_.Below(rows_));
    return {column, row};
  }
  Eigen::Vector3d Spot(const Window& window, double across, double up) const {
    return {0, (window.column - 0.5 * columns_ + across) * kWidth / columns_,
            (window.row - 0.5 * rows_ + up) * kHeight / rows_};
  }
  Eigen::Vector2d See(const Eigen::Vector3d& point_in_map) {
    const double x = random_.Gaussian(1.0 / kFocalPx);
    const double y = random_.Gaussian(1.0 / kFocalPx);
    return (camera_from_map_ * point_in_map).hnormalized() + Eigen::Vector2d(x, y);
  }

  const RepeatedPatternOptions& options_;
  Random& random_;
  const Rigid3 camera_from_map_ = CameraInFront();
  const int columns_;
  const int rows_;
  const std::uint32_t kinds_;
  Window shift_;
};

}  // namespace

PoseProblem MakeRepeatedPattern(const RepeatedPatternOptions& options, Random& random) {
  PoseProblem problem;
  problem.focal_length_px = kFocalPx;
  problem.gravity_sigma_rad = kGravitySigmaRad;
  problem.gravity_in_camera = NoisyGravityInCamera(CameraInFront(), kGravitySigmaRad, random);
  Facade facade(options, random);
  for (int i = 0; i < options.matches; ++i) facade.AddMatch(&problem);
  return problem;
}

}  // namespace maploc::testing
