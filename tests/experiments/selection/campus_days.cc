#include "tests/experiments/selection/campus_days.h"

namespace maploc::selection {

// A row a kind (in the order of LandmarkKind): unseen, look_alike, flip.
//   walls' corners and stains | leaves | ground | edges of walls | trunks | branches | scaffolds
const std::vector<CampusDay>& CampusDays() {
  static const std::vector<CampusDay> kDays = {
      // A few weeks after the mapping drive.
      {"summer",
       0.5,
       {{{0.15, 0.79, 0.05},
         {0.20, 0.70, 0.05},
         {0.20, 0.60, 0.05},
         {0.15, 0.60, 0.05},
         {0.15, 0.50, 0.05},
         {0.40, 0.92, 0.05},
         {0.30, 0.85, 0.05}}}},
      // Leaves have turned and lie on the ground; the sun stands lower.
      {"autumn",
       0.7,
       {{{0.25, 0.90, 0.08},
         {0.35, 0.82, 0.08},
         {0.40, 0.80, 0.08},
         {0.20, 0.65, 0.08},
         {0.20, 0.60, 0.08},
         {0.40, 0.93, 0.08},
         {0.40, 0.95, 0.08}}}},
      // Snow hides texture, not edges; no leaves, but evergreens and twigs where they were.
      {"winter",
       1.0,
       {{{0.30, 0.935, 0.10},
         {0.80, 0.93, 0.10},
         {0.85, 0.95, 0.10},
         {0.25, 0.70, 0.10},
         {0.20, 0.60, 0.10},
         {0.30, 0.95, 0.10},
         {0.40, 0.97, 0.10}}}},
      // Lamps and lit windows: few corners as they were; windows keep their outlines.
      {"night",
       0.7,
       {{{0.50, 0.96, 0.13},
         {0.50, 0.92, 0.13},
         {0.50, 0.90, 0.13},
         {0.35, 0.78, 0.13},
         {0.40, 0.80, 0.13},
         {0.60, 0.97, 0.13},
         {0.50, 0.97, 0.13}}}},
      // New leaves, much as last summer's from afar.
      {"spring",
       0.5,
       {{{0.25, 0.865, 0.08},
         {0.35, 0.80, 0.08},
         {0.30, 0.70, 0.08},
         {0.20, 0.65, 0.08},
         {0.20, 0.60, 0.08},
         {0.40, 0.93, 0.08},
         {0.40, 0.95, 0.08}}}},
      // Wet walls, puddles, drops on the lens; leaves move.
      {"rain",
       1.0,
       {{{0.35, 0.935, 0.10},
         {0.35, 0.85, 0.10},
         {0.40, 0.80, 0.10},
         {0.25, 0.70, 0.10},
         {0.25, 0.70, 0.10},
         {0.50, 0.95, 0.10},
         {0.40, 0.95, 0.10}}}},
  };
  return kDays;
}

CampusOptions CampusPlaces() {
  CampusOptions places;
  places.sites = {Site::kHouses, Site::kTrees,        Site::kSquare, Site::kHouses, Site::kTrees,
                  Site::kHouses, Site::kConstruction, Site::kTrees,  Site::kHouses, Site::kTrees};
  places.stretch_length_m = 36.0;
  // Trees are points above all: a detector finds a leaf's corner more easily than a branch among
  // leaves.
  places.wall_points_a_house = 150;
  places.rich_fronts = true;
  places.leaves_a_tree = 120;
  places.branches_a_tree = 10;
  return places;
}

}  // namespace maploc::selection
