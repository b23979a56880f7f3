// Gravity in a wrong frame, and gravity that is merely wrong.
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "mapstore/geometry/gravity.h"
#include "tests/experiments/lies/lie.h"

namespace maploc::lies {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSigmasDeg[] = {0.5, 1.0};
constexpr double kTurnsDeg[] = {3, 5, 7, 10, 15, 20, 30, 45, 60, 90, 135, 180};

using MistakeFn = Eigen::Vector3d (*)(const Eigen::Vector3d& true_gravity,
                                      const Rigid3& map_from_camera);

struct FrameMistake {
  const char* name;
  MistakeFn gravity;
};

// x right, y down, z forward is the camera's frame. What is sent instead:
const FrameMistake kFrameMistakes[] = {
    {"constant z", [](const Eigen::Vector3d&, const Rigid3&) { return Eigen::Vector3d(0, 0, 1); }},
    {"the map's own (0,0,-1)",
     [](const Eigen::Vector3d&, const Rigid3&) { return Eigen::Vector3d(0, 0, -1); }},
    {"constant x", [](const Eigen::Vector3d&, const Rigid3&) { return Eigen::Vector3d(1, 0, 0); }},
    {"up for down", [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(-g); }},
    {"body NED",
     [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(g.z(), g.x(), g.y()); }},
    {"body FLU", [](const Eigen::Vector3d& g,
                    const Rigid3&) { return Eigen::Vector3d(g.z(), -g.x(), -g.y()); }},
    {"cyclic yzx",
     [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(g.y(), g.z(), g.x()); }},
    {"x and y exchanged",
     [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(g.y(), g.x(), g.z()); }},
    {"y and z exchanged",
     [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(g.x(), g.z(), g.y()); }},
    {"x and z exchanged",
     [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(g.z(), g.y(), g.x()); }},
    {"x flipped",
     [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(-g.x(), g.y(), g.z()); }},
    {"y flipped",
     [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(g.x(), -g.y(), g.z()); }},
    {"z flipped",
     [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(g.x(), g.y(), -g.z()); }},
    {"OpenGL's camera", [](const Eigen::Vector3d& g,
                           const Rigid3&) { return Eigen::Vector3d(g.x(), -g.y(), -g.z()); }},
    {"portrait for landscape",
     [](const Eigen::Vector3d& g, const Rigid3&) { return Eigen::Vector3d(-g.y(), g.x(), g.z()); }},
    {"rotation inverted",
     [](const Eigen::Vector3d&, const Rigid3& map_from_camera) {
       return Eigen::Vector3d(map_from_camera.rotation * kGravityInMap);
     }},
};

// Perpendicular to `direction`, any with equal probability.
Eigen::Vector3d RandomPerpendicular(const Eigen::Vector3d& direction, Random& random) {
  const double angle = random.Uniform(-std::numbers::pi, std::numbers::pi);
  const Eigen::Vector3d a = direction.unitOrthogonal();
  return std::cos(angle) * a + std::sin(angle) * direction.cross(a);
}

Query WithGravity(Query query, const Eigen::Vector3d& gravity, double sigma_deg) {
  query.gravity = Gravity{gravity.normalized(), sigma_deg * kDegree};
  return query;
}

Lie Mistake(const FrameMistake& mistake, double sigma_deg, int features) {
  return {"frame", std::string(mistake.name), features > 0,
          [mistake, sigma_deg, features](const HonestQuery& honest, int,
                                         Random& random) -> Result<Query> {
            const Eigen::Vector3d truth = honest.query.gravity->direction_in_body;
            Query query = WithGravity(honest.query, mistake.gravity(truth, honest.map_from_camera),
                                      sigma_deg);
            if (features > 0) KeepSomePoints(features, random, query.views[0].points);
            return query;
          }};
}

Lie Turn(double turn_deg, double sigma_deg, int features) {
  return {"turn", std::to_string(static_cast<int>(turn_deg)) + " degrees", true,
          [=](const HonestQuery& honest, int, Random& random) -> Result<Query> {
            const Eigen::Vector3d truth = honest.query.gravity->direction_in_body;
            const Eigen::AngleAxisd turn(turn_deg * kDegree, RandomPerpendicular(truth, random));
            Query query = WithGravity(honest.query, turn * truth, sigma_deg);
            if (features > 0) KeepSomePoints(features, random, query.views[0].points);
            return query;
          }};
}

std::string Suffix(double sigma_deg, int features) {
  std::string suffix = sigma_deg < 1 ? ", sigma 0.5" : ", sigma 1";
  if (features > 0) suffix += ", " + std::to_string(features) + " features";
  return suffix;
}

}  // namespace

std::vector<Lie> GravityLies() {
  std::vector<Lie> lies;
  for (const int features : {0, 800}) {
    for (const double sigma_deg : kSigmasDeg) {
      for (const FrameMistake& mistake : kFrameMistakes) {
        lies.push_back(Mistake(mistake, sigma_deg, features));
        lies.back().name += Suffix(sigma_deg, features);
      }
      for (const double turn_deg : kTurnsDeg) {
        lies.push_back(Turn(turn_deg, sigma_deg, features));
        lies.back().name += Suffix(sigma_deg, features);
      }
    }
  }
  return lies;
}

}  // namespace maploc::lies
