#include "tests/experiments/chance_matches.h"

#include "tests/experiments/protocol.h"
#include "tests/support/moved_signs.h"
#include "tests/support/repeated_pattern.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::experiments {
namespace {

int MatchCount(Random& random) { return 100 + static_cast<int>(random.Below(1901)); }

}  // namespace

PoseProblem MakeRandomMatches(double line_share, Random& random) {
  const int matches = MatchCount(random);
  testing::SyntheticOptions options;
  options.scene = random.Below(2) == 0 ? testing::Scene::kCube : testing::Scene::kCorridor;
  options.outliers = random.Below(2) == 0 ? testing::Outliers::kRandomPixels
                                          : testing::Outliers::kWrongAssociations;
  options.point_inliers = 0;
  options.line_outliers = static_cast<int>(line_share * matches);
  options.point_outliers = matches - options.line_outliers;
  options.vertical_line_share = random.Below(2) == 0 ? 0.0 : 0.8;
  options.gravity_sigma_rad = random.Uniform(0.1, 2.0) * kDegree;
  return testing::MakeSyntheticProblem(options, random).problem;
}

PoseProblem MakeFacade(double line_share, double shifted_share, Random& random) {
  return testing::MakeRepeatedPattern(
      {.matches = MatchCount(random), .line_share = line_share, .shifted_share = shifted_share},
      random);
}

PoseProblem MakeSigns(Random& random) {
  testing::MovedSignsOptions options;
  options.signs = 2 + static_cast<int>(random.Below(3));
  options.features = 5 + static_cast<int>(random.Below(11));
  options.radius_px = random.Uniform(8, 30);
  options.others = 10 + static_cast<int>(random.Below(51));
  options.gravity_sigma_rad = random.Uniform(0.1, 2.0) * kDegree;
  return testing::MakeMovedSigns(options, random);
}

}  // namespace maploc::experiments
