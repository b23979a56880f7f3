#include "client/robot/simulated_world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace maploc {
namespace {

constexpr double kHouseLengthM = 10.0;
constexpr double kHouseGapM = 2.5;
constexpr double kHouseOffsetM = 7.0;  // of its front from the lane's middle
constexpr double kFloorHeightM = 3.2;
constexpr double kWindowWidthM = 1.0;
constexpr double kWindowHeightM = 1.5;
constexpr int kFloors = 2;
constexpr int kWindowsAFloor = 5;
constexpr int kBushesAStretch = 3;  // of a structured one
constexpr int kLeavesABush = 10;
constexpr int kTreesAStretch = 16;  // of an unstructured one
constexpr int kGroundPointsAStretch = 40;
constexpr double kSquareOffsetM = 6.0;  // of its houses' fronts, beyond those of a row of houses
constexpr int kTreesASquare = 4;
constexpr int kPavementPointsASquare = 120;
constexpr double kScaffoldLengthM = 12.0;
constexpr double kScaffoldGapM = 3.0;
constexpr double kScaffoldBayM = 2.5;
constexpr int kScaffoldLevels = 4;
constexpr int kSignPointsAScaffold = 40;  // boards and fence in front of it

class Builder {
 public:
  // Every draw comes from one generator, in a fixed order: a draw added in between gives another
  // campus for the same seed, and the demo's figures no longer hold. What is optional (rich fronts,
  // sites) draws only where it is asked for.
  explicit Builder(const CampusOptions& options) : random_(options.seed) {
    world_.options = options;
    std::vector<Site>& sites = world_.options.sites;
    for (int i = 0; options.sites.empty() && i < options.stretches; ++i) {
      sites.push_back(i % 2 == 0 ? Site::kHouses : Site::kTrees);
    }
    world_.options.stretches = static_cast<int>(sites.size());
    world_.radius_m = world_.LaneLength() / (2.0 * std::numbers::pi);
  }

  World Build() {
    for (stretch_ = 0; stretch_ < world_.options.stretches; ++stretch_) {
      begin_m_ = stretch_ * world_.options.stretch_length_m;
      AddSite();
      AddGround();
    }
    return std::move(world_);
  }

 private:
  void AddSite() {
    switch (world_.SiteOf(stretch_)) {
      case Site::kHouses:
        return AddStructured();
      case Site::kTrees:
        return AddTrees(kTreesAStretch);
      case Site::kSquare:
        return AddSquare();
      case Site::kConstruction:
        return AddConstruction();
    }
  }

  // As many as the stretch has room for, along both sides: `add` gets the middle and the side.
  template <typename Add>
  void AlongBothSides(double pitch_m, double offset_m, const Add& add) {
    for (const double side : {1.0, -1.0}) {
      // On the inside of the circle the same arc is shorter.
      const double shrink = (world_.radius_m + side * offset_m) / world_.radius_m;
      const int count = static_cast<int>(world_.options.stretch_length_m * shrink / pitch_m);
      for (int i = 0; i < count; ++i) {
        add(begin_m_ + (i + 0.5) * world_.options.stretch_length_m / count, side);
      }
    }
  }

  void AddStructured() {
    AlongBothSides(kHouseLengthM + kHouseGapM, kHouseOffsetM,
                   [&](double along_m, double side) { AddHouse(along_m, side, kHouseOffsetM); });
    for (int i = 0; i < kBushesAStretch; ++i) {
      const Eigen::Vector3d at = AnywhereBeside(3.5, 6.0, 0.6);
      AddCrown(at, 0.6, kLeavesABush);
    }
  }

  void AddTrees(int count) {
    for (int i = 0; i < count; ++i) AddTree(AnywhereBeside(4.0, 13.0, 0.0));
  }

  void AddSquare() {
    const double offset_m = kHouseOffsetM + kSquareOffsetM;
    AlongBothSides(kHouseLengthM + kHouseGapM, offset_m,
                   [&](double along_m, double side) { AddHouse(along_m, side, offset_m); });
    AddTrees(kTreesASquare);
    for (int i = 0; i < kPavementPointsASquare; ++i) {
      AddPoint(AnywhereBeside(1.0, 10.0, 0.0), LandmarkKind::kGroundPoint, -1);
    }
  }

  void AddConstruction() {
    AlongBothSides(kScaffoldLengthM + kScaffoldGapM, kHouseOffsetM,
                   [&](double along_m, double side) { AddScaffold(along_m, side); });
  }

  // Poles and planks before a raw wall, which hides what is behind; signs and a fence before it.
  void AddScaffold(double along_m, double side) {
    const double heading = world_.HeadingAt(along_m) + random_.Uniform(-0.1, 0.1);
    const Eigen::Vector3d along(std::cos(heading), std::sin(heading), 0.0);
    const Eigen::Vector3d outward(along.y(), -along.x(), 0.0);
    const double height_m = kScaffoldLevels * 2.0;
    const Eigen::Vector3d origin =
        world_.PointAt(along_m, side * kHouseOffsetM, 0.0) - along * (kScaffoldLengthM / 2.0);
    const int wall = static_cast<int>(world_.walls.size());
    world_.walls.push_back({origin.head<2>(), (origin + along * kScaffoldLengthM).head<2>(),
                            (-side * outward).head<2>(), height_m});
    const auto at = [&](double u, double v) -> Eigen::Vector3d {
      return origin + along * u + Eigen::Vector3d(0, 0, v);
    };
    for (double u = 0.0; u <= kScaffoldLengthM; u += kScaffoldBayM) {
      AddLine({at(u, 0.0), at(u, height_m)}, LandmarkKind::kScaffoldLine, wall);
      for (int level = 1; level <= kScaffoldLevels && u + kScaffoldBayM <= kScaffoldLengthM;
           ++level) {
        AddLine({at(u, 2.0 * level), at(u + kScaffoldBayM, 2.0 * level)},
                LandmarkKind::kScaffoldLine, wall);
      }
    }
    for (int i = 0; i < kSignPointsAScaffold; ++i) {
      AddPoint(at(random_.Uniform(0.0, kScaffoldLengthM), random_.Uniform(0.3, 2.2)) -
                   side * outward * random_.Uniform(0.3, 1.0),
               LandmarkKind::kWallPoint, wall);
    }
  }

  void AddGround() {
    for (int i = 0; i < kGroundPointsAStretch; ++i) {
      AddPoint(AnywhereBeside(1.0, 6.0, random_.Uniform(0.0, 0.25)), LandmarkKind::kGroundPoint,
               -1);
    }
  }

  // A front of kFloors x kWindowsAFloor windows, turned a little against the lane.
  void AddHouse(double along_m, double side, double front_m) {
    const double offset_m = side * (front_m + random_.Uniform(0.0, 2.0));
    const Eigen::Vector3d middle = world_.PointAt(along_m, offset_m, 0.0);
    const double turn = world_.HeadingAt(along_m) + random_.Uniform(-0.15, 0.15);
    const Eigen::Vector3d along(std::cos(turn), std::sin(turn), 0.0);
    const Eigen::Vector3d outward(along.y(), -along.x(), 0.0);  // right of the lane
    const double height_m = kFloors * kFloorHeightM + random_.Uniform(0.5, 1.5);
    const Eigen::Vector3d origin = middle - along * (kHouseLengthM / 2.0);
    const int wall = static_cast<int>(world_.walls.size());
    world_.walls.push_back({origin.head<2>(), (origin + along * kHouseLengthM).head<2>(),
                            (-side * outward).head<2>(), height_m});
    const auto at = [&](double u, double v) -> Eigen::Vector3d {
      return origin + along * u + Eigen::Vector3d(0, 0, v);
    };
    AddOutline(at(0.0, 0.0), at(kHouseLengthM, 0.0), at(kHouseLengthM, height_m), at(0.0, height_m),
               wall);
    for (int floor = 0; floor < kFloors; ++floor) {
      for (int window = 0; window < kWindowsAFloor; ++window) {
        const double u = (window + 0.5) * kHouseLengthM / kWindowsAFloor - kWindowWidthM / 2.0 +
                         random_.Uniform(-0.25, 0.25);
        const double v = floor * kFloorHeightM + 0.9 + random_.Uniform(-0.15, 0.15);
        AddOutline(at(u, v), at(u + kWindowWidthM, v), at(u + kWindowWidthM, v + kWindowHeightM),
                   at(u, v + kWindowHeightM), wall);
        if (world_.options.rich_fronts) AddWindowDetail(at, u, v, wall);
      }
      if (world_.options.rich_fronts) AddCornice(at, (floor + 1) * kFloorHeightM, wall);
    }
    for (int i = 0; i < world_.options.wall_points_a_house; ++i) {
      AddPoint(at(random_.Uniform(0.0, kHouseLengthM), random_.Uniform(0.2, height_m)),
               LandmarkKind::kWallPoint, wall);
    }
  }

  // `at` is a place on the front: along it, and up.
  template <typename At>
  void AddWindowDetail(const At& at, double u, double v, int wall) {
    const double middle_u = u + kWindowWidthM / 2.0;
    const double bar_v = v + 0.6 * kWindowHeightM;
    AddLine({at(middle_u, v), at(middle_u, v + kWindowHeightM)}, LandmarkKind::kWallLine, wall);
    AddLine({at(u, bar_v), at(u + kWindowWidthM, bar_v)}, LandmarkKind::kWallLine, wall);
    AddLine({at(u - 0.15, v - 0.12), at(u + kWindowWidthM + 0.15, v - 0.12)},
            LandmarkKind::kWallLine, wall);
    AddPoint(at(middle_u, bar_v), LandmarkKind::kWallPoint, wall);
  }

  // Two edges; a detector breaks them where pipes and posters cross.
  template <typename At>
  void AddCornice(const At& at, double height_m, int wall) {
    for (const double v : {height_m, height_m + 0.25}) {
      for (double u = 0.0; u < kHouseLengthM; u += 2.5) {
        AddLine({at(u, v), at(u + 2.5, v)}, LandmarkKind::kWallLine, wall);
      }
    }
  }

  // Four edges and four corners.
  void AddOutline(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                  const Eigen::Vector3d& d, int wall) {
    for (const Eigen::Vector3d& corner : {a, b, c, d}) {
      AddPoint(corner, LandmarkKind::kWallPoint, wall);
    }
    AddLine({a, b}, LandmarkKind::kWallLine, wall);
    AddLine({b, c}, LandmarkKind::kWallLine, wall);
    AddLine({d, c}, LandmarkKind::kWallLine, wall);
    AddLine({a, d}, LandmarkKind::kWallLine, wall);
  }

  void AddTree(const Eigen::Vector3d& foot) {
    const double crown_m = random_.Uniform(1.2, 2.2);
    const double height_m = random_.Uniform(2.5, 4.5);
    const Eigen::Vector3d top = foot + Eigen::Vector3d(0, 0, height_m);
    world_.trees.push_back({foot.head<2>(), crown_m});
    // A trunk is seen as its two edges.
    for (const double side : {-0.15, 0.15}) {
      const Eigen::Vector3d shift(side, 0.0, 0.0);
      AddLine({foot + shift, top + shift * 0.8}, LandmarkKind::kTrunkLine, -1);
    }
    AddCrown(top, crown_m, world_.options.leaves_a_tree);
    for (int i = 0; i < world_.options.branches_a_tree; ++i) {
      const Eigen::Vector3d from = top + Direction() * random_.Uniform(0.1, 0.6) * crown_m;
      AddLine({from, from + Direction() * random_.Uniform(1.0, 2.5)}, LandmarkKind::kBranchLine,
              -1);
    }
  }

  void AddCrown(const Eigen::Vector3d& middle, double radius_m, int leaves) {
    for (int i = 0; i < leaves; ++i) {
      AddPoint(middle + Direction() * radius_m * random_.Uniform(0.6, 1.0),
               LandmarkKind::kLeafPoint, -1);
    }
  }

  void AddPoint(const Eigen::Vector3d& position, LandmarkKind kind, int wall) {
    world_.points.push_back({position, kind, stretch_, wall, RandomDescriptor(random_)});
  }
  void AddLine(const LineSegment3& segment, LandmarkKind kind, int wall) {
    world_.lines.push_back({segment, kind, stretch_, wall, RandomDescriptor(random_)});
  }

  Eigen::Vector3d AnywhereBeside(double near_m, double far_m, double height_m) {
    const double along_m = begin_m_ + random_.Uniform(0.0, world_.options.stretch_length_m);
    const double side = random_.Uniform() < 0.7 ? 1.0 : -1.0;  // the robots look to the outside
    return world_.PointAt(along_m, side * random_.Uniform(near_m, far_m), height_m);
  }
  Eigen::Vector3d Direction() {
    return Eigen::Vector3d(random_.Gaussian(), random_.Gaussian(), random_.Gaussian()).normalized();
  }

  Random random_;
  World world_;
  int stretch_ = 0;
  double begin_m_ = 0.0;
};

}  // namespace

int World::StretchAt(double along_m) const {
  const double wrapped = along_m - LaneLength() * std::floor(along_m / LaneLength());
  // Rounding may leave the whole lane, which is one stretch too far.
  return std::min(static_cast<int>(wrapped / options.stretch_length_m), options.stretches - 1);
}

Eigen::Vector3d World::PointAt(double along_m, double aside_m, double height_m) const {
  const double angle = along_m / radius_m;
  return {(radius_m + aside_m) * std::cos(angle), (radius_m + aside_m) * std::sin(angle), height_m};
}

double World::HeadingAt(double along_m) const {
  return along_m / radius_m + std::numbers::pi / 2.0;
}

World MakeCampus(const CampusOptions& options) { return Builder(options).Build(); }

}  // namespace maploc
