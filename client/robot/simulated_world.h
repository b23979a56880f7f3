// A small made-up campus: a circular lane with houses along some stretches (walls, windows,
// vertical edges) and trees along others; squares and building sites where they are asked for.
// Right-handed, z up, metres; the lane's ground is z = 0 and its centre the origin; the lane runs
// counterclockwise from (radius, 0).
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "client/robot/appearance.h"
#include "mapstore/geometry/line.h"
#include "mapstore/geometry/rigid3.h"

namespace maploc {

// What stands along a stretch.
enum class Site {
  kHouses,
  kTrees,
  kSquare,       // houses farther off, a few trees, much pavement
  kConstruction  // scaffolds, and a few signs
};

struct CampusOptions {
  int stretches = 6;             // houses and trees by turns, beginning with houses; at least 2
  std::vector<Site> sites = {};  // not empty: one a stretch instead, and `stretches` is their count
  double stretch_length_m = 45.0;
  int wall_points_a_house = 30;  // stains, lamps, notices
  bool rich_fronts = false;      // with sills, glazing bars and cornices
  int leaves_a_tree = 32;
  int branches_a_tree = 32;
  std::uint64_t seed = 1;
};

struct WorldPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  LandmarkKind kind = LandmarkKind::kWallPoint;
  int stretch = 0;
  int wall = -1;  // index of the wall it lies on; -1: none
  BinaryDescriptor descriptor{};
};

struct WorldLine {
  LineSegment3 segment;
  LandmarkKind kind = LandmarkKind::kWallLine;
  int stretch = 0;
  int wall = -1;
  BinaryDescriptor descriptor{};
};

// A house front, seen from the side of its normal alone; hides what is behind it.
struct Wall {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  // unit, towards the lane
  double height_m = 0.0;
};

struct Tree {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double crown_radius_m = 0.0;
};

struct World {
  CampusOptions options;
  double radius_m = 0.0;  // of the lane
  std::vector<WorldPoint> points;
  std::vector<WorldLine> lines;
  std::vector<Wall> walls;
  std::vector<Tree> trees;

  double LaneLength() const { return options.stretches * options.stretch_length_m; }
  // The stretch at a distance along the lane (any real number; the lane is a circle).
  int StretchAt(double along_m) const;
  Site SiteOf(int stretch) const { return options.sites[stretch]; }
  bool IsStructured(int stretch) const { return SiteOf(stretch) == Site::kHouses; }
  // The point `aside_m` to the right of the lane's middle, and the heading there.
  Eigen::Vector3d PointAt(double along_m, double aside_m, double height_m) const;
  double HeadingAt(double along_m) const;  // radians, counterclockwise from x
};

// The same options give the same world, to the bit.
World MakeCampus(const CampusOptions& options);

}  // namespace maploc
