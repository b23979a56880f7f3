#include "mapstore/importers/line_triangulator.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "mapstore/importers/frame_neighbours.h"
#include "mapstore/importers/line_geometry.h"
#include "tests/support/seed.h"
#include "tests/unit/mapstore/importers/drawn_scene.h"

namespace maploc {
namespace {

using testing::DistanceFromLine;

std::vector<FrameLines> SeeAll(const testing::DrawnScene& scene, double noise_px, Random& random) {
  std::vector<FrameLines> seen;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    seen.push_back(SeeLines(scene, i, noise_px, random));
  }
  return seen;
}

std::vector<LineTrackInMap> Triangulate(const testing::DrawnScene& scene,
                                        const std::vector<FrameLines>& seen) {
  return TriangulateLines(scene.frames, seen, FindFrameNeighbours(scene.frames, {}));
}

double DistanceFromNearest(const LineSegment3& found, const std::vector<LineSegment3>& truths) {
  double nearest = std::numeric_limits<double>::max();
  for (const LineSegment3& truth : truths) {
    nearest = std::min(nearest, DistanceFromLine(found, truth));
  }
  return nearest;
}

TEST(TriangulateLinesTest, RecoversEveryLineExactlyWithoutNoise) {
  Random random = testing::TestRandom();
  const testing::DrawnScene scene = testing::MakeScene(random, 8, 60);
  const auto tracks = Triangulate(scene, SeeAll(scene, 0.0, random));
  EXPECT_GT(tracks.size(), 45u);
  EXPECT_LE(tracks.size(), 60u);
  for (const LineTrackInMap& track : tracks) {
    EXPECT_LT(DistanceFromNearest(track.segment_in_map, scene.lines), 1e-6);
    EXPECT_GE(track.frames.size(), 3u);
    EXPECT_EQ(track.descriptors.size() % 32, 0u);
  }
}

TEST(TriangulateLinesTest, StaysWithinCentimetresUnderNoise) {
  Random random = testing::TestRandom();
  const testing::DrawnScene scene = testing::MakeScene(random, 8, 60);
  const auto tracks = Triangulate(scene, SeeAll(scene, 0.4, random));
  EXPECT_GT(tracks.size(), 40u);
  std::vector<double> errors;
  for (const LineTrackInMap& track : tracks) {
    errors.push_back(DistanceFromNearest(track.segment_in_map, scene.lines));
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.03);
  EXPECT_LT(errors[errors.size() * 9 / 10], 0.1);
}

TEST(TriangulateLinesTest, TwoViewsAreNotEnough) {
  Random random = testing::TestRandom();
  const testing::DrawnScene scene = testing::MakeScene(random, 2, 40);
  EXPECT_TRUE(Triangulate(scene, SeeAll(scene, 0.0, random)).empty());
}

// A line along the walk lies in one plane with all camera centres: its depth is anybody's guess.
TEST(TriangulateLinesTest, ALineAlongTheEpipoleIsLeftOut) {
  Random random = testing::TestRandom();
  testing::DrawnScene scene = testing::MakeScene(random, 8, 1);
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    scene.frames[i] =
        testing::MakeFrame(static_cast<int>(i), {0.2 * static_cast<double>(i), -8, 1.5});
  }
  scene.lines[0] = {{-1, 0, 2.5}, {1, 0, 2.5}};
  EXPECT_TRUE(Triangulate(scene, SeeAll(scene, 0.3, random)).empty());
}

TEST(TriangulateLinesTest, ForeignSegmentsMakeNoLines) {
  Random random = testing::TestRandom();
  const testing::DrawnScene scene = testing::MakeScene(random, 8, 60);
  std::vector<FrameLines> seen = SeeAll(scene, 0.0, random);
  for (FrameLines& of_frame : seen) {  // each frame sees segments where no other frame does
    for (LineSegment2& segment : of_frame.normalized) {
      const Eigen::Vector2d start(random.Uniform(-0.6, 0.6), random.Uniform(-0.5, 0.5));
      const double angle = random.Uniform(0, 6.28);
      segment = {start, start + 0.1 * Eigen::Vector2d(std::cos(angle), std::sin(angle))};
    }
  }
  EXPECT_LE(Triangulate(scene, seen).size(), 2u);
}

TEST(RefineLineTest, BoundsTheLineByWhatWasSeenTwice) {
  const LineSegment3 truth{{0, 0, 0}, {0, 0, 2}};
  std::vector<LineObservation> views;
  for (int i = 0; i < 4; ++i) {
    const KeyFrame frame = testing::MakeFrame(i, {0.5 * i - 1.0, -8, 1.5});
    const auto see = [&](double z) {
      const Eigen::Vector3d p = frame.camera_from_map * Eigen::Vector3d(0, 0, z);
      return Eigen::Vector2d(p.head<2>() / p.z());
    };
    views.push_back({frame.camera_from_map, {see(0.1 * i), see(2 - 0.2 * i)}, 800});
  }
  const auto refined = RefineLine(views, {{0.1, 0.2, 0.3}, {-0.1, -0.1, 1.5}});
  ASSERT_TRUE(refined.has_value());
  EXPECT_LT(DistanceFromLine(refined->segment_in_map, truth), 1e-9);
  EXPECT_NEAR(refined->segment_in_map.start.z(), 0.1, 1e-6);
  EXPECT_NEAR(refined->segment_in_map.end.z(), 1.8, 1e-6);
}

TEST(RefineLineTest, ViewsOfOnePlaceDoNotDetermineALine) {
  const KeyFrame frame = testing::MakeFrame(0, {0, -8, 1.5});
  const LineObservation view{frame.camera_from_map, {{0, 0.1}, {0.05, -0.1}}, 800};
  const std::vector<LineObservation> views = {view, view, view};
  EXPECT_FALSE(RefineLine(views, {{0, 0, 0.7}, {0.4, 0, 2.3}}).has_value());
}

TEST(IntersectPlanesTest, RefusesParallelPlanesAndOppositeDirections) {
  const KeyFrame a = testing::MakeFrame(0, {-1, -8, 1.5});
  const KeyFrame b = testing::MakeFrame(1, {1, -8, 1.5});
  const auto see = [](const KeyFrame& frame, const Eigen::Vector3d& point) {
    const Eigen::Vector3d p = frame.camera_from_map * point;
    return Eigen::Vector2d(p.head<2>() / p.z());
  };
  const auto observe = [&](const KeyFrame& frame, const Eigen::Vector3d& s,
                           const Eigen::Vector3d& e) {
    return LineObservation{frame.camera_from_map, {see(frame, s), see(frame, e)}, 800};
  };
  const Eigen::Vector3d low(0, 0, 0), high(0.3, 0, 2);
  const auto line = IntersectPlanes(observe(a, low, high), observe(b, low, high), 0.02);
  ASSERT_TRUE(line.has_value());
  EXPECT_LT((line->start - low).norm() + (line->end - high).norm(), 1e-9);
  EXPECT_FALSE(IntersectPlanes(observe(a, low, high), observe(b, high, low), 0.02).has_value());
  const Eigen::Vector3d left(-1, 0, 2.5), right(1, 0, 2.5);  // along the base line
  EXPECT_FALSE(IntersectPlanes(observe(a, left, right), observe(b, left, right), 0.02).has_value());
}

}  // namespace
}  // namespace maploc
