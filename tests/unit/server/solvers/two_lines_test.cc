// Why there is no 2L strategy (paper section III-C; design.md section 5): two lines cannot give a
// pose of four degrees of freedom, however they lie.
//
// Proof. A line gives two equations: n . Rz(a) D = 0 and n . (Rz(a) L + t) = 0. The first of each
// holds the yaw alone: two equations for one unknown. The second of each is one equation for t: two
// for three unknowns. So the translation along n1 x n2 stays free, and one constraint is spent
// twice. In the four unknowns (a, t) the Jacobian of all four equations has rank 3 at most.
#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "server/solvers/aligned.h"
#include "tests/support/seed.h"
#include "tests/unit/server/solvers/upright_scene.h"

namespace maploc::testing {
namespace {

struct SeenLine {
  Eigen::Vector3d normal, point, direction;
};

SeenLine MakeLine(const AlignedPose& truth, Random& random) {
  SeenLine line;
  line.point = 5.0 * RandomDirection(random);
  line.direction = RandomDirection(random);
  line.normal = (truth * line.point).cross(truth * (line.point + line.direction));
  return line;
}

AlignedPose RandomPose(Random& random) {
  const double yaw = random.Uniform(-3, 3);
  return {{std::cos(yaw), std::sin(yaw)}, RandomDirection(random)};
}

TEST(TwoLines, TheirFourEquationsHaveRankThreeAtMost) {
  Random random = TestRandom();
  for (int i = 0; i < 1000; ++i) {
    const AlignedPose pose = RandomPose(random);
    const SeenLine lines[2] = {MakeLine(pose, random), MakeLine(pose, random)};
    // d Rz(a) v / da = z x Rz(a) v.
    const Eigen::Vector3d up(0, 0, 1);
    Eigen::Matrix4d jacobian = Eigen::Matrix4d::Zero();
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d n = lines[k].normal.normalized();
      jacobian(2 * k, 0) = n.dot(up.cross(TurnByYaw(pose.yaw, lines[k].direction)));
      jacobian(2 * k + 1, 0) = n.dot(up.cross(TurnByYaw(pose.yaw, lines[k].point)));
      jacobian.block<1, 3>(2 * k + 1, 1) = n.transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix4d> svd(jacobian);
    EXPECT_LT(svd.singularValues()(3), 1e-12 * svd.singularValues()(0));
  }
}

TEST(TwoLines, TheTranslationAlongBothPlanesIsFree) {
  Random random = TestRandom();
  for (int i = 0; i < 1000; ++i) {
    const AlignedPose pose = RandomPose(random);
    const SeenLine lines[2] = {MakeLine(pose, random), MakeLine(pose, random)};
    AlignedPose moved = pose;
    moved.translation += 3.0 * lines[0].normal.cross(lines[1].normal).normalized();
    for (const SeenLine& line : lines) {
      const Eigen::Vector3d n = line.normal.normalized();
      EXPECT_NEAR(n.dot(moved * line.point), 0, 1e-12);
      EXPECT_NEAR(n.dot(moved * (line.point + line.direction)), 0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace maploc::testing
